#include <gtest/gtest.h>

#include <algorithm>

#include "tests/architecture/SourceTree.h"

namespace perception::test {
namespace {

std::size_t linesOf(const SourceFile& file) {
  return static_cast<std::size_t>(std::count(file.text.begin(), file.text.end(), '\n'));
}

bool isText(const SourceFile& file) { return file.text.find('\0') == std::string::npos; }

// An absolute path of somebody's machine. Written in parts, so that this file holds none.
const std::regex& machinePath() {
  static const std::regex pattern(std::string(R"re((^|[\s"'=(`:,])/)re") +
                                  "(work|home|root|tmp|Users)/[A-Za-z0-9_.-]");
  return pattern;
}

std::vector<int> linesWithMachinePath(const SourceFile& file) {
  std::vector<int> lines;
  std::istringstream in(file.text);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find('/') != std::string::npos && std::regex_search(line, machinePath()))
      lines.push_back(number);
  }
  return lines;
}

TEST(Repository, MainsOnlyStartTheirApp) {
  for (const SourceFile& file : filesBelow("apps")) {
    if (!file.isSource()) continue;
    EXPECT_LE(linesOf(file), 15u) << file.path;
  }
}

TEST(Repository, EveryProgramHasAReadme) {
  for (const SourceFile& file : filesBelow("apps")) {
    if (!file.isSource()) continue;
    const auto readme =
        std::filesystem::path(PERCEPTION_SOURCE_DIR) / firstFolders(file.path, 2) / "README.md";
    EXPECT_TRUE(std::filesystem::exists(readme)) << file.path;
  }
}

TEST(Repository, HeadersAreIncludedOnceByPragma) {
  for (const char* folder : {"libperception", "gui-offscreen", "tests"}) {
    for (const SourceFile& file : filesBelow(folder)) {
      if (!file.isHeader()) continue;
      EXPECT_NE(file.text.find("#pragma once"), std::string::npos) << file.path;
    }
  }
}

TEST(Repository, NoFileNamesAPathOfAMachine) {
  std::size_t files = 0;
  for (const SourceFile& file : filesBelow("")) {
    if (!isText(file)) continue;
    ++files;
    for (const int line : linesWithMachinePath(file)) ADD_FAILURE() << file.path << ":" << line;
  }
  EXPECT_GT(files, 50u);
}

TEST(Repository, TheSearchForMachinePathsFindsOne) {
  const std::string home = std::string("/ho") + "me/somebody/log.rawlog";
  EXPECT_EQ(linesWithMachinePath({"a", "x\ninput = " + home + "\n"}), std::vector<int>{2});
  EXPECT_EQ(linesWithMachinePath({"a", "\"" + home + "\""}), std::vector<int>{1});
  EXPECT_TRUE(
      linesWithMachinePath({"a", "home/page, /usr/bin/env, tests/home/x, /dev/full"}).empty());
}

TEST(Repository, OurTextIsCleanUtf8WithoutTabsInCode) {
  for (const char* folder : {"libperception", "gui-offscreen", "apps", "tests"}) {
    for (const SourceFile& file : filesBelow(folder)) {
      if (!file.isHeader() && !file.isSource()) continue;
      EXPECT_EQ(file.text.find('\t'), std::string::npos) << file.path << ": a tab";
      EXPECT_EQ(file.text.find('\r'), std::string::npos) << file.path << ": a carriage return";
      EXPECT_TRUE(file.text.empty() || file.text.back() == '\n')
          << file.path << ": no line end at the end";
    }
  }
}

// A checkout may lie in a folder whose name has a space.
TEST(Repository, NoTestHandsItsFolderToAShellWithoutQuotes) {
  const std::regex bare(R"re([^'"\\ =,({] +"\s*PERCEPTION_(SOURCE|BINARY)_DIR)re");
  const std::string shell =
      "\"/usr/bin/python3 \" PERCEPTION_SOURCE_"
      "DIR \"/a.py\"";
  EXPECT_TRUE(std::regex_search(shell, bare));
  EXPECT_FALSE(
      std::regex_search("\"cd '\"\n  PERCEPTION_SOURCE_"
                        "DIR",
                        bare));
  for (const SourceFile& file : filesBelow("tests"))
    EXPECT_FALSE(file.isSource() && std::regex_search(file.text, bare)) << file.path;
}

}  // namespace
}  // namespace perception::test
