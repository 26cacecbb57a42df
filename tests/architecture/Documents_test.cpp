#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "tests/architecture/SourceTree.h"

// What the documents promise: README is short, links lead to headings that exist, files and options
// that stand in code quotes exist.
namespace perception::test {
namespace {

using Words = std::set<std::string>;

bool isDocument(const SourceFile& file) {
  return std::filesystem::path(file.path).extension() == ".md";
}

std::vector<SourceFile> documents() {
  std::vector<SourceFile> found = filesBelow("");
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const SourceFile& file) { return !isDocument(file); }),
              found.end());
  return found;
}

/// The lines of the text, in code blocks or outside of them.
std::vector<std::string> linesInCode(const std::string& text, bool in_code) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  bool code = false;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("```", 0) == 0)
      code = !code;
    else if (code == in_code)
      lines.push_back(line);
  }
  return lines;
}

/// The anchor of a heading, as GitHub makes it: lower case, blanks as hyphens, other signs gone.
std::string anchorOf(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto letter = static_cast<unsigned char>(c);
    if (c == ' ' || c == '-') anchor += '-';
    if (std::isalnum(letter) || c == '_' || letter >= 128)
      anchor += static_cast<char>(std::tolower(letter));
  }
  return anchor;
}

Words anchorsOf(const std::string& text) {
  static const std::regex marks(R"re(^#+ +(.*?) *$)re"), link(R"re(\[([^\]]*)\]\([^)]*\))re");
  Words anchors;
  for (const std::string& line : linesInCode(text, false)) {
    std::smatch match;
    if (!std::regex_match(line, match, marks)) continue;
    const std::string anchor = anchorOf(std::regex_replace(match[1].str(), link, "$1"));
    std::string numbered = anchor;
    for (int i = 1; !anchors.insert(numbered).second; ++i)
      numbered = anchor + "-" + std::to_string(i);
  }
  return anchors;
}

/// Links of the document to headings that do not exist. `textOf` gives the text of a path.
template <typename TextOf>
std::vector<std::string> lostAnchors(const SourceFile& document, const TextOf& textOf) {
  static const std::regex link(R"re(\]\(([^)#\s]*)#([^)\s]+)\))re");
  std::vector<std::string> lost;
  for (const std::string& line : linesInCode(document.text, false)) {
    for (std::sregex_iterator i(line.begin(), line.end(), link), end; i != end; ++i) {
      const std::string target = (*i)[1], anchor = (*i)[2];
      if (target.find("://") != std::string::npos) continue;
      const std::filesystem::path folder = std::filesystem::path(document.path).parent_path();
      const std::string path = (folder / target).lexically_normal().generic_string();
      const std::string text = target.empty() ? document.text : textOf(path);
      if (anchorsOf(text).count(anchor) == 0) lost.push_back(target + "#" + anchor);
    }
  }
  return lost;
}

TEST(Documents, ReadmeIsReadInFiveMinutes) {
  const std::string text = readWhole(std::filesystem::path(PERCEPTION_SOURCE_DIR) / "README.md");
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 120);
  std::istringstream in(text);
  int words = 0;
  for (std::string word; in >> word;) ++words;
  EXPECT_LE(words, 1000);
  EXPECT_GT(words, 200) << "is this the README?";
}

TEST(Documents, EveryModuleSaysWhatComesInWhatGoesOutAndHowToReadIt) {
  const auto modules = std::filesystem::path(PERCEPTION_SOURCE_DIR) / "libperception";
  for (const auto& entry : std::filesystem::directory_iterator(modules)) {
    if (!entry.is_directory()) continue;
    const std::string text = readWhole(entry.path() / "README.md");
    for (const char* part : {"- **In:** ", "- **Out:** ", "- **Read:** "})
      EXPECT_NE(text.find(part), std::string::npos) << entry.path() << "/README.md: " << part;
  }
}

TEST(Documents, EveryLinkLeadsToAHeading) {
  const std::filesystem::path root(PERCEPTION_SOURCE_DIR);
  for (const SourceFile& document : documents()) {
    for (const std::string& link :
         lostAnchors(document, [&](const std::string& path) { return readWhole(root / path); }))
      ADD_FAILURE() << document.path << ": " << link;
  }
}

TEST(Documents, TheSearchForHeadingsKnowsHowTheyBecomeAnchors) {
  EXPECT_EQ(
      anchorsOf("# A, b & `c_d`\n## [E](x.md) f-g\n```\n# no heading\n```\n## A, b & `c_d`\n"),
      (Words{"a-b--c_d", "e-f-g", "a-b--c_d-1"}));
  const SourceFile document = {"docs/a.md", "# One\n[x](#one) [y](#two) [z](b.md#three)\n"};
  EXPECT_EQ(lostAnchors(document, [](const std::string&) { return "# Four"; }),
            (std::vector<std::string>{"#two", "b.md#three"}));
}

/// In code quotes: what is between backticks in one paragraph, and the lines of code blocks.
std::vector<std::string> quotedCode(const std::string& text) {
  std::vector<std::string> code = linesInCode(text, true);
  std::string paragraph;
  const auto close = [&] {
    std::size_t open = paragraph.find('`');
    while (open != std::string::npos) {
      const std::size_t end = paragraph.find('`', open + 1);
      if (end == std::string::npos) break;
      code.push_back(paragraph.substr(open + 1, end - open - 1));
      open = paragraph.find('`', end + 1);
    }
    paragraph.clear();
  };
  for (const std::string& line : linesInCode(text, false)) {
    if (line.rfind("    ", 0) == 0) code.push_back(line);
    if (line.empty()) close();
    paragraph += line + "\n";
  }
  close();
  return code;
}

/// Sources, scripts and INIs that the document names in code quotes and that are nowhere in the
/// tree. A path may be one from the root, from the document, or the end of one.
std::vector<std::string> unknownFiles(const SourceFile& document, const Words& ends) {
  static const std::regex name(
      R"re((^|[\s'"(=])([\w./-]+\.(?:h|cpp|sh|py|cmake))(?=$|[\s'",;:)]))re");
  std::vector<std::string> unknown;
  for (const std::string& code : quotedCode(document.text)) {
    for (std::sregex_iterator i(code.begin(), code.end(), name), end; i != end; ++i) {
      std::string path = (*i)[2];
      while (path.rfind("./", 0) == 0 || path.rfind("../", 0) == 0)
        path = path.substr(path.find('/') + 1);
      if (path.find("NAME") == std::string::npos && ends.count(path) == 0) unknown.push_back(path);
    }
  }
  return unknown;
}

/// All ends of the path: "a/b/c.h", "b/c.h", "c.h".
void addEnds(const std::string& path, Words& ends) {
  ends.insert(path);
  for (std::size_t at = path.find('/'); at != std::string::npos; at = path.find('/', at + 1))
    ends.insert(path.substr(at + 1));
}

// Files of other projects that the documents name.
const Words kFilesOfOthers = {"OpenCVConfig.cmake"};

TEST(Documents, FilesInCodeQuotesExist) {
  Words ends = kFilesOfOthers;
  for (const SourceFile& file : filesBelow("")) addEnds(file.path, ends);
  for (const SourceFile& document : documents()) {
    if (document.name() == "CHANGELOG.md") continue;
    for (const std::string& file : unknownFiles(document, ends))
      ADD_FAILURE() << document.path << ": " << file;
  }
}

TEST(Documents, TheSearchForFilesFindsOneThatIsNotThere) {
  Words ends;
  addEnds("libperception/core/math/Angle.h", ends);
  addEnds("setup.sh", ends);
  const auto in = [&](const std::string& text) { return unknownFiles({"docs/a.md", text}, ends); };
  EXPECT_TRUE(in("`core/math/Angle.h`, `Angle.h`\n```\n./setup.sh demo\n```\n").empty());
  EXPECT_EQ(in("see `core/Gone.h` and `NAME.cpp`"), std::vector<std::string>{"core/Gone.h"});
  EXPECT_EQ(in("```\nbash gone.sh\n```\n"), std::vector<std::string>{"gone.sh"});
}

/// Options as code writes them: "--name".
Words optionsDeclared(const std::vector<SourceFile>& files) {
  const char* const letters = "abcdefghijklmnopqrstuvwxyz0123456789-";
  Words options;
  for (const SourceFile& file : files) {
    std::size_t at = file.text.find("--");
    while (at != std::string::npos) {
      const std::size_t end = std::min(file.text.find_first_not_of(letters, at), file.text.size());
      options.insert(file.text.substr(at, end - at));
      at = file.text.find("--", end);
    }
  }
  return options;
}

/// Options that a line of code gives to one of our programs; what follows a pipe or a comment
/// belongs to others.
std::vector<std::string> optionsGiven(const std::string& code) {
  static const std::regex option(R"re((^|[\s\[(])(--[a-z][a-z0-9-]+))re");
  std::vector<std::string> options;
  const std::size_t program = code.find("perception-");
  if (program == std::string::npos) return options;
  const std::string behind = code.substr(program, code.find_first_of("#;|", program) - program);
  for (std::sregex_iterator i(behind.begin(), behind.end(), option), end; i != end; ++i)
    options.push_back((*i)[2]);
  return options;
}

/// Names of our programs in the line: NAME of perception-NAME, but not of libperception-NAME.
std::vector<std::string> programsNamed(const std::string& code) {
  static const std::string prefix = "perception-";
  std::vector<std::string> names;
  for (std::size_t at = code.find(prefix); at != std::string::npos; at = code.find(prefix, at)) {
    const bool whole = at == 0 || std::isalnum(static_cast<unsigned char>(code[at - 1])) == 0;
    at += prefix.size();
    const std::size_t end = code.find_first_not_of("abcdefghijklmnopqrstuvwxyz", at);
    if (whole) names.push_back(code.substr(at, end - at));
  }
  return names;
}

TEST(Documents, ProgramsThatTheyNameExist) {
  const std::filesystem::path root(PERCEPTION_SOURCE_DIR);
  for (const SourceFile& document : documents()) {
    for (const std::string& line : quotedCode(document.text)) {
      for (const std::string& name : programsNamed(line)) {
        const bool placeholder = name.empty();  // perception-NAME
        EXPECT_TRUE(placeholder || std::filesystem::exists(root / "apps" / ("perception-" + name)))
            << document.path << ": " << line;
      }
    }
  }
}

TEST(Documents, TheSearchForProgramsLeavesPackagesOut) {
  EXPECT_EQ(programsNamed("perception-track a | build/bin/perception-gone"),
            (std::vector<std::string>{"track", "gone"}));
  EXPECT_TRUE(programsNamed("apt install libperception-dev").empty());
}

TEST(Documents, OptionsOfCommandsAreDeclared) {
  std::vector<SourceFile> code = filesBelow("libperception");
  for (const char* folder : {"studies", "apps", "gui-offscreen"}) {
    for (const SourceFile& file : filesBelow(folder)) code.push_back(file);
  }
  code.erase(std::remove_if(code.begin(), code.end(), isDocument), code.end());
  const Words declared = optionsDeclared(code);
  ASSERT_GT(declared.size(), 100u);
  int given = 0;
  for (const SourceFile& document : documents()) {
    if (document.name() == "CHANGELOG.md") continue;
    for (const std::string& line : quotedCode(document.text)) {
      for (const std::string& option : optionsGiven(line)) {
        ++given;
        EXPECT_EQ(declared.count(option), 1u) << document.path << ": " << line;
      }
    }
  }
  EXPECT_GT(given, 100);
}

TEST(Documents, TheSearchForOptionsFindsThoseOfOurProgramsAlone) {
  EXPECT_EQ(optionsGiven("build/bin/perception-track -c a.ini --sensors L # --no"),
            std::vector<std::string>{"--sensors"});
  EXPECT_TRUE(optionsGiven("cmake --build build").empty());
  EXPECT_EQ(optionsDeclared({{"a.cpp", "add(\"-s,--sensors\", x);"}}), Words{"--sensors"});
}

}  // namespace
}  // namespace perception::test
