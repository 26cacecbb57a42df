#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/architecture/SourceTree.h"

// Several sources of a module are compiled as one: a constant or a type of an anonymous namespace
// has its name alone in the module.
namespace perception::test {
namespace {

/// Constants and types at the level of a source's anonymous namespaces.
std::set<std::string> hiddenNames(const std::string& text) {
  static const std::regex type(R"(^(?:struct|class|enum|enum class) (\w+))");
  static const std::regex constant(R"(^(?:inline |static )?(?:constexpr|const) [^(;=]*\bk[A-Z])");
  static const std::regex name(R"(\b(k[A-Z]\w*)(?:\[[^\]]*\])*(?: =|\{))");
  std::set<std::string> names;
  std::istringstream in(text);
  bool hidden = false;
  for (std::string line; std::getline(in, line);) {
    if (line == "namespace {") hidden = true;
    if (line == "}  // namespace") hidden = false;
    if (!hidden) continue;
    line = line.substr(0, line.find("//"));
    std::smatch found;
    if (std::regex_search(line, found, type)) names.insert(found[1]);
    if (!std::regex_search(line, constant)) continue;
    for (std::sregex_iterator i(line.begin(), line.end(), name), end; i != end; ++i)
      names.insert((*i)[1]);
  }
  return names;
}

/// libperception/filter/state/Track.cpp: libperception/filter.
std::string folderOfModule(const std::string& path) {
  const std::size_t first = path.find('/');
  const bool deep = path.rfind("libperception/", 0) == 0 || path.rfind("tests/", 0) == 0;
  return path.substr(0, deep ? path.find('/', first + 1) : first);
}

std::vector<std::string> namesThereTwice(const std::vector<SourceFile>& files) {
  std::map<std::string, std::string> homes;  // by module and name
  std::vector<std::string> twice;
  for (const SourceFile& file : files) {
    if (!file.isSource()) continue;
    for (const std::string& name : hiddenNames(file.text)) {
      const auto [home, is_new] = homes.emplace(folderOfModule(file.path) + ' ' + name, file.path);
      if (!is_new) twice.push_back(name + ": " + home->second + ", " + file.path);
    }
  }
  return twice;
}

TEST(Names, OfAnonymousNamespacesAreUniqueInAModule) {
  std::vector<SourceFile> files;
  for (const char* folder : {"libperception", "gui-offscreen", "studies", "tests"}) {
    for (SourceFile& file : filesBelow(folder)) {
      // A program each, or compiled apart from their module.
      static const std::regex alone(
          R"(^tests/(bench|fuzz|examples|faults)/|/plugin/|Kernels\w+\.cpp$)");
      if (!std::regex_search(file.path, alone)) files.push_back(std::move(file));
    }
  }
  ASSERT_GT(files.size(), 500U);
  for (const std::string& fault : namesThereTwice(files)) ADD_FAILURE() << fault;
}

TEST(Names, TheCheckerFindsThem) {
  const std::vector<SourceFile> files = {
      {"libperception/a/One.cpp",
       "namespace {\nconstexpr int kFew = 3, kMany = 9;\nstruct Row {\n"},
      {"libperception/a/b/Two.cpp",
       "namespace {\nconst double kMany = 2;\n}  // namespace\nstruct Row {\n"},
      {"libperception/c/Three.cpp",
       "namespace {\nconstexpr int kFew = 3;\nvoid f() {\n  const int kMany = 1;\n"},
      {"tests/a/One_test.cpp", "namespace {\nstruct Row {\n"},
  };
  EXPECT_EQ(namesThereTwice(files),
            std::vector<std::string>{"kMany: libperception/a/One.cpp, libperception/a/b/Two.cpp"});
}

}  // namespace
}  // namespace perception::test
