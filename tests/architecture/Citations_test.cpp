#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/architecture/SourceTree.h"

namespace perception::test {
namespace {

using Names = std::set<std::string>;

/// What may be cited.
struct Citable {
  Names sections;   ///< of docs/method.md, as "5.6"
  Names equations;  ///< of docs/method.md, as "(12)"
  Names keys;       ///< of docs/references.bib
  Names paths;      ///< files and folders from the root
  Names names;      ///< names of files, without their folders
};

// Results of the programs and placeholders of explanations: no files of the tree.
const Names kResults = {"report.md", "errors.md"};
const std::regex& placeholder() {
  static const std::regex pattern(R"re((^|/)(X|XApp|NAME|MODULE|perception-NAME|site)([./]|$))re");
  return pattern;
}

std::vector<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i)
    found.push_back(i->size() > 1 ? (*i)[1] : (*i)[0]);
  return found;
}

/// The text as one line; markers of comments at the beginnings of its lines left out.
std::string joined(const std::string& text) {
  std::string out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const std::size_t begin = line.find_first_not_of(" /#;*");
    if (begin != std::string::npos) out += line.substr(begin);
    out += ' ';
  }
  return out;
}

/// All sections and equations that follow `word` in a joined text: "5.6, 7.1 and (12)".
std::vector<std::string> numbersBehind(const std::string& text, const std::string& word) {
  static const std::regex list(
      R"re(^[\]`)]*:? *(\d+(?:\.\d+)*|\(\d+\))(?:(?:, | and |, and | to )(?:\d+\.\d+|\(\d+\)))*)re");
  static const std::regex number(R"re(\(\d+\)|\d+(?:\.\d+)*)re");
  std::vector<std::string> found;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::string behind = text.substr(at + word.size(), 80);
    std::smatch match;
    if (!std::regex_search(behind, match, list)) continue;
    const std::string numbers = match.str();
    for (std::sregex_iterator i(numbers.begin(), numbers.end(), number), end; i != end; ++i)
      found.push_back(i->str());
  }
  return found;
}

std::vector<std::string> keysCitedIn(const std::string& text) {
  static const std::regex key(R"re(\[([a-z]+[0-9]{4}[a-z]?)\])re");
  return matches(text, key);
}

/// Sections, equations and works that the file cites and that do not exist.
std::vector<std::string> citationFaults(const SourceFile& file, const Citable& citable) {
  const std::string text = joined(file.text);
  std::vector<std::string> faults;
  const auto check = [&](const std::string& word) {
    for (const std::string& number : numbersBehind(text, word)) {
      const Names& known = number[0] == '(' ? citable.equations : citable.sections;
      if (known.count(number) == 0) faults.push_back(word + number);
    }
  };
  check("method.md ");
  if (file.name() == "method.md") {
    for (const char* word : {"section ", "sections ", "Section ", "eq. "}) check(word);
  }
  for (const std::string& key : keysCitedIn(file.text)) {
    if (citable.keys.count(key) == 0) faults.push_back("[" + key + "]");
  }
  return faults;
}

/// A path, or the beginning of one, as in `tests/bench/kitti_*`.
bool leadsToAFile(std::string path, const Names& paths) {
  while (!path.empty() && (path.back() == '.' || path.back() == ',')) path.pop_back();
  if (std::regex_search(path, placeholder())) return true;
  if (!path.empty() && path.back() == '/') path.pop_back();
  const auto next = paths.lower_bound(path);
  return next != paths.end() && next->rfind(path, 0) == 0;
}

/// The comments of code, everything of other files.
std::string proseOf(const SourceFile& file) {
  if (!file.isHeader() && !file.isSource()) return file.text;
  std::string out;
  std::istringstream in(file.text);
  for (std::string line; std::getline(in, line);) {
    const std::size_t comment = line.find("//");
    if (comment != std::string::npos) out += line.substr(comment);
    out += '\n';
  }
  return out;
}

// An entry of CHANGELOG names files of its day.
bool isDated(const SourceFile& file) { return file.name() == "CHANGELOG.md"; }

/// Documents, links and paths that the file names and that are not in the tree.
std::vector<std::string> referenceFaults(const SourceFile& file, const Citable& citable) {
  // Written in parts, so that this file names none.
  static const std::regex former(
      "\\b(SP"
      "EC|EXP"
      "ECTED|VISION_N"
      "OTES|DECI"
      "SIONS|DES"
      "IGN)(?:\\.md|\\b)");
  static const std::regex document(R"re((?:^|[^\w.$}/-])([A-Za-z_][\w-]*\.md)\b)re");
  static const std::regex link(R"re(\]\(([^)#\s]+)(?:#[^)]*)?\))re");
  static const std::regex path(
      R"re((?:^|[^\w./$}-])((?:libperception|gui-offscreen|studies|apps|ini|tests|docs|rawlogs|cmake)/[\w./-]*))re");
  static const std::regex source(R"re((?:^|[^\w/.])([A-Z]\w+\.(?:cpp|h))\b)re");
  std::vector<std::string> faults;
  std::istringstream in(proseOf(file));
  for (std::string line; std::getline(in, line);) {
    for (const std::string& name : matches(line, former)) faults.push_back(name);
    for (const std::string& name : matches(line, document)) {
      if (citable.names.count(name) == 0 && kResults.count(name) == 0) faults.push_back(name);
    }
    if (!isDated(file)) {
      for (const std::string& name : matches(line, path)) {
        if (!leadsToAFile(name, citable.paths)) faults.push_back(name);
      }
    }
    if (file.name().size() < 3 || file.name().substr(file.name().size() - 3) != ".md") continue;
    for (const std::string& target : matches(line, link)) {
      if (target.find("://") != std::string::npos) continue;
      std::string full = (std::filesystem::path(file.path).parent_path() / target)
                             .lexically_normal()
                             .generic_string();
      if (!full.empty() && full.back() == '/') full.pop_back();
      if (full != "." && citable.paths.count(full) == 0) faults.push_back(target);
    }
    if (isDated(file)) continue;
    for (const std::string& name : matches(line, source)) {
      if (citable.names.count(name) == 0) faults.push_back(name);
    }
  }
  return faults;
}

bool isProse(const SourceFile& file) {
  static const Names kinds = {".cpp", ".h", ".md", ".ini", ".sh", ".py", ".cmake", ".txt", ".bib"};
  return kinds.count(std::filesystem::path(file.path).extension().string()) != 0;
}

const std::vector<SourceFile>& tree() {
  static const std::vector<SourceFile> files = filesBelow("");
  return files;
}

std::string fileText(const std::string& path) {
  return readWhole(std::filesystem::path(PERCEPTION_SOURCE_DIR) / path);
}

std::vector<std::string> equationsOf(const std::string& method) {
  static const std::regex tag(R"re(\\tag\{(\d+)\})re");
  return matches(method, tag);
}

Citable citableOfTree() {
  Citable citable;
  std::istringstream method(fileText("docs/method.md"));
  static const std::regex heading(R"re(^#+ (\d+(?:\.\d+)*) )re");
  for (std::string line; std::getline(method, line);) {
    for (const std::string& number : matches(line, heading)) citable.sections.insert(number);
  }
  for (const std::string& number : equationsOf(method.str()))
    citable.equations.insert("(" + number + ")");
  std::istringstream bib(fileText("docs/references.bib"));
  static const std::regex entry(R"re(^@\w+\{([^,]+),)re");
  for (std::string line; std::getline(bib, line);) {
    for (const std::string& key : matches(line, entry)) citable.keys.insert(key);
  }
  for (const SourceFile& file : tree()) {
    citable.names.insert(file.name());
    std::filesystem::path path(file.path);
    for (; !path.empty(); path = path.parent_path()) citable.paths.insert(path.generic_string());
  }
  return citable;
}

TEST(Citations, EverySectionEquationAndWorkExists) {
  const Citable citable = citableOfTree();
  ASSERT_GT(citable.sections.size(), 50u);
  ASSERT_GT(citable.keys.size(), 50u);
  for (const SourceFile& file : tree()) {
    if (!isProse(file) || file.name() == "Citations_test.cpp") continue;
    for (const std::string& fault : citationFaults(file, citable))
      ADD_FAILURE() << file.path << ": " << fault;
  }
}

TEST(Citations, EveryDocumentLinkAndPathExists) {
  const Citable citable = citableOfTree();
  for (const SourceFile& file : tree()) {
    if (!isProse(file) || file.name() == "Citations_test.cpp") continue;
    for (const std::string& fault : referenceFaults(file, citable))
      ADD_FAILURE() << file.path << ": " << fault;
  }
}

TEST(Citations, EquationsAreNumberedWithoutGaps) {
  const auto equations = equationsOf(fileText("docs/method.md"));
  ASSERT_FALSE(equations.empty());
  for (std::size_t i = 0; i < equations.size(); ++i) EXPECT_EQ(equations[i], std::to_string(i + 1));
}

TEST(Citations, EveryWorkIsCited) {
  Names cited;
  for (const SourceFile& file : tree()) {
    if (!isProse(file) || file.name() == "Citations_test.cpp") continue;
    for (const std::string& key : keysCitedIn(file.text)) cited.insert(key);
  }
  for (const std::string& key : citableOfTree().keys)
    EXPECT_EQ(cited.count(key), 1u) << "docs/references.bib: " << key;
}

// A small tree to make faults in.
Citable smallTree() {
  return {{"5", "5.6"},
          {"(1)", "(2)"},
          {"doe2001"},
          {"docs", "docs/method.md", "ini", "ini/demo.ini", "README.md"},
          {"method.md", "demo.ini", "README.md"}};
}

std::vector<std::string> citationFaultsIn(const std::string& name, const std::string& text) {
  return citationFaults({name, text}, smallTree());
}

std::vector<std::string> referenceFaultsIn(const std::string& name, const std::string& text) {
  return referenceFaults({name, text}, smallTree());
}

using Faults = std::vector<std::string>;

TEST(Citations, TheCheckerFindsWhatIsNotThere) {
  EXPECT_EQ(citationFaultsIn("a.cpp", "// method.md 5.7\n"), Faults{"method.md 5.7"});
  EXPECT_EQ(citationFaultsIn("a.cpp", "// method.md (3)\n"), Faults{"method.md (3)"});
  EXPECT_EQ(citationFaultsIn("a.h", "  /// as in method.md\n  /// 6, not\n"),
            Faults{"method.md 6"});
  EXPECT_EQ(citationFaultsIn("a.ini", "; method.md 5.6, (7) and 9.1\n"),
            (Faults{"method.md (7)", "method.md 9.1"}));
  EXPECT_EQ(citationFaultsIn("a.cpp", "// [roe2002]\n"), Faults{"[roe2002]"});
  EXPECT_EQ(citationFaultsIn("docs/method.md", "see section 5.9 and eq. (4)\n"),
            (Faults{"section 5.9", "eq. (4)"}));
}

TEST(Citations, TheCheckerFindsReferencesToNothing) {
  EXPECT_EQ(referenceFaultsIn("README.md", "[x](docs/gone.md)"),
            (Faults{"docs/gone.md", "docs/gone.md"}));
  EXPECT_EQ(referenceFaultsIn("docs/method.md", "[x](../ini/gone)"), Faults{"../ini/gone"});
  EXPECT_EQ(referenceFaultsIn("README.md", "`ini/gone.ini`"), Faults{"ini/gone.ini"});
  EXPECT_EQ(referenceFaultsIn("README.md", "see `Gone.cpp`"), Faults{"Gone.cpp"});
  EXPECT_EQ(referenceFaultsIn("a.cpp", "int x;  // docs/gone\n"), Faults{"docs/gone"});
  EXPECT_EQ(referenceFaultsIn("a.cpp",
                              "// SP"
                              "EC 5\n"),
            Faults{"SP"
                   "EC"});
}

TEST(Citations, TheCheckerAllowsWhatIsThere) {
  const std::string code =
      "// method.md 5.6, (2); [doe2001]; 5.7 m\nopen(\"ini/gone.ini\");  // ini/demo, "
      "docs/method.md\n";
  EXPECT_EQ(citationFaultsIn("a.cpp", code), Faults{});
  EXPECT_EQ(referenceFaultsIn("a.cpp", code), Faults{});
  EXPECT_EQ(referenceFaultsIn("docs/method.md", "[x](../README.md#part), [y](https://z.org/a.md)"),
            Faults{});
}

}  // namespace
}  // namespace perception::test
