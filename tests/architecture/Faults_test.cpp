// docs/faults.md names a test for every fault.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/architecture/SourceTree.h"

namespace perception::test {
namespace {

/// `Suite.Name` of all tests of the tree.
std::set<std::string> testsOf(const std::vector<SourceFile>& files) {
  static const std::regex head(R"re(TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\))re");
  std::set<std::string> tests;
  for (const SourceFile& file : files) {
    if (!file.isSource()) continue;
    for (std::sregex_iterator i(file.text.begin(), file.text.end(), head), end; i != end; ++i)
      tests.insert((*i)[1].str() + "." + (*i)[2].str());
  }
  return tests;
}

/// The `Suite.Name` that a text cites.
std::vector<std::string> citedIn(const std::string& text) {
  static const std::regex cited(R"re(`([A-Z]\w+\.[A-Z]\w+)`)re");
  std::vector<std::string> tests;
  for (std::sregex_iterator i(text.begin(), text.end(), cited), end; i != end; ++i)
    tests.push_back((*i)[1]);
  return tests;
}

TEST(Faults, EachTestThatIsNamedExists) {
  const auto tests = testsOf(filesBelow("tests"));
  const auto named =
      citedIn(readWhole(std::filesystem::path(PERCEPTION_SOURCE_DIR) / "docs/faults.md"));
  EXPECT_GT(named.size(), 40u);
  for (const std::string& test : named) EXPECT_EQ(tests.count(test), 1u) << test;
}

TEST(Faults, TheSearchTellsTestsFromOtherWords) {
  EXPECT_EQ(citedIn("`A.b` `App.Runs`, done.json"), std::vector<std::string>{"App.Runs"});
  const std::string text = std::string("TEST") + "(App, Runs) {}\nTEST" + "_F(Log,\n  Ends) {}";
  EXPECT_EQ(testsOf({{"a_test.cpp", text}}), (std::set<std::string>{"App.Runs", "Log.Ends"}));
}

}  // namespace
}  // namespace perception::test
