#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/architecture/SourceTree.h"

// Builds compile several sources at once (PERCEPTION_UNITY), where a source may lean on what an
// earlier one includes. These rules, read from the text, keep each source whole by itself.
namespace perception::test {
namespace {

using Paths = std::set<std::string>;

/// The text without comments and without what stands between quotes.
std::string codeOf(const std::string& text) {
  std::string code;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      while (i < text.size() && text[i] != '\n') ++i;
      code += '\n';
    } else if (text.compare(i, 2, "/*") == 0) {
      i = std::min(text.find("*/", i), text.size() - 2) + 1;
    } else if (text.compare(i, 3, "R\"(") == 0) {
      i = std::min(text.find(")\"", i), text.size() - 2) + 1;
    } else if (text[i] == '"') {
      for (++i; i < text.size() && text[i] != '"' && text[i] != '\n'; ++i) i += text[i] == '\\';
    } else {
      code += text[i];
    }
  }
  return code;
}

/// A named type: defined or only declared, at the level of a namespace or within something.
struct NamedType {
  std::string name;
  bool defined = false, nested = false;
};

std::vector<NamedType> typesOf(const std::string& code) {
  static const std::regex type(
      R"((^|\n)([ \t]*)(?:template ?<[^\n]*>\s)?[ \t]*(?:struct|class|enum class|enum|union) (\w+)([^\n]*))");
  static const std::regex alias(R"((^|\n)([ \t]*)using (\w+) =)");
  std::vector<NamedType> types;
  for (std::sregex_iterator i(code.begin(), code.end(), type), end; i != end; ++i) {
    const std::string rest = (*i)[4];
    types.push_back({(*i)[3],
                     rest.find(';') == std::string::npos || rest.find('{') < rest.find(';'),
                     (*i)[2].length() > 0});
  }
  for (std::sregex_iterator i(code.begin(), code.end(), alias), end; i != end; ++i)
    types.push_back({(*i)[3], true, (*i)[2].length() > 0});
  return types;
}

/// What the files of a tree define and include.
class TypeTable {
 public:
  explicit TypeTable(const std::vector<SourceFile>& files) {
    for (const SourceFile& file : files) {
      code_[file.path] = codeOf(file.text);
      for (const Include& include : includesOf(file))
        if (include.quoted) includes_[file.path].insert(include.path);
      for (const NamedType& t : typesOf(code_[file.path])) {
        named_[file.path].insert(t.name);
        if (inner(code_[file.path]) || t.nested)
          nested_.insert(t.name);
        else if (file.isHeader() && t.defined)
          homes_[t.name].insert(file.path);
      }
    }
  }

  /// Names that two headers define: one of the definitions is taken for both in a program that
  /// links them.
  std::vector<std::string> definedTwice() const {
    std::vector<std::string> twice;
    for (const auto& [name, homes] : homes_)
      if (homes.size() > 1) twice.push_back(name + ": " + *homes.begin() + ", " + *homes.rbegin());
    return twice;
  }

  /// Types that the file names but whose header it does not reach through its includes, and that
  /// none of them declares.
  std::vector<std::string> outOfReach(const std::string& path) const {
    const Paths reached = reach(path);
    std::vector<std::string> faults;
    for (const std::string& word : wordsOf(code_.at(path))) {
      const auto home = homes_.find(word);
      if (home == homes_.end() || nested_.count(word)) continue;
      bool known = reached.count(*home->second.begin()) > 0;
      for (const std::string& file : reached) {
        const auto names = named_.find(file);
        known = known || (names != named_.end() && names->second.count(word));
      }
      if (!known) faults.push_back(word + " of " + *home->second.begin());
    }
    return faults;
  }

 private:
  /// Namespaces within perception, but that of the tests, have types of their own
  /// (perception::ros).
  static bool inner(const std::string& code) {
    static const std::regex space(R"(\nnamespace perception::(?!test\b)\w+)");
    return std::regex_search(code, space);
  }

  static std::set<std::string> wordsOf(const std::string& code) {
    static const std::regex word(R"((::|\.|->|TEST(?:_[FP])?\()?\b([A-Za-z_]\w*)\b)");
    std::set<std::string> words;
    for (std::sregex_iterator i(code.begin(), code.end(), word), end; i != end; ++i)
      if ((*i)[1].length() == 0) words.insert((*i)[2]);
    return words;
  }

  Paths reach(const std::string& path) const {
    Paths reached, open = {path};
    while (!open.empty()) {
      const std::string next = *open.begin();
      open.erase(open.begin());
      if (!reached.insert(next).second) continue;
      const auto found = includes_.find(next);
      if (found == includes_.end()) continue;
      for (const std::string& include : found->second)
        if (!reached.count(include)) open.insert(include);
    }
    return reached;
  }

  std::map<std::string, std::string> code_;
  std::map<std::string, Paths> includes_, homes_, named_;
  std::set<std::string> nested_;
};

std::vector<SourceFile> allSources() {
  std::vector<SourceFile> sources;
  for (const char* folder : {"libperception", "gui-offscreen", "studies", "apps", "tests"}) {
    for (SourceFile& file : filesBelow(folder)) {
      if (file.isHeader() || file.isSource()) sources.push_back(std::move(file));
    }
  }
  return sources;
}

TEST(Includes, NoTwoHeadersDefineATypeOfTheSameName) {
  std::vector<SourceFile> product;
  for (SourceFile& file : allSources())
    if (file.path.rfind("tests/", 0) != 0) product.push_back(std::move(file));
  const TypeTable table(product);
  for (const std::string& fault : table.definedTwice()) ADD_FAILURE() << fault;
}

TEST(Includes, EachFileReachesTheHeadersOfTheTypesThatItNames) {
  const auto sources = allSources();
  ASSERT_GT(sources.size(), 500U);
  const TypeTable table(sources);
  for (const SourceFile& file : sources)
    for (const std::string& fault : table.outOfReach(file.path))
      ADD_FAILURE() << file.path << " names " << fault << " and does not include it";
}

TEST(Includes, TheCheckerFindsWhatIsMissing) {
  const std::vector<SourceFile> files = {
      {"a/Car.h", "struct Car {\n  int doors;\n};\nclass Bus;\n"},
      {"b/Bus.h", "#include \"a/Car.h\"\nclass Bus : Car {\n};\n"},
      {"b/Car.h", "enum class Car { kSmall };\n"},
      {"b/Through.cpp", "#include \"b/Bus.h\"\nCar car;\n"},
      {"b/Declared.cpp", "#include \"a/Car.h\"\nBus* bus;  // Wagon\n"},
      {"b/Missing.cpp", "const char* text = \"Car\";\nBus* bus;\n"},
  };
  const TypeTable table(files);
  EXPECT_EQ(table.definedTwice(), std::vector<std::string>{"Car: a/Car.h, b/Car.h"});
  EXPECT_TRUE(table.outOfReach("b/Through.cpp").empty());
  EXPECT_TRUE(table.outOfReach("b/Declared.cpp").empty());
  EXPECT_EQ(table.outOfReach("b/Missing.cpp"), std::vector<std::string>{"Bus of b/Bus.h"});
}

}  // namespace
}  // namespace perception::test
