#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/DocumentCommands.h"
#include "tests/support/CommandOutput.h"
#include "tests/support/TemporaryFolder.h"

// What README promises of its commands. Its lines in Python are run by
// tests/python/examples_test.py.
namespace perception {
namespace {

namespace fs = std::filesystem;
using test::CommandOutput;

const std::string kReadme = PERCEPTION_SOURCE_DIR "/README.md";

std::string wholeText(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Commands that setup.sh takes, by its line of usage.
std::set<std::string> commandsOfSetup() {
  const std::string text = wholeText(PERCEPTION_SOURCE_DIR "/setup.sh");
  const auto begin = text.find("usage: ./setup.sh "), end = text.find('"', begin);
  std::istringstream in(text.substr(begin + 18, end - begin - 18));
  std::set<std::string> commands;
  for (std::string word; in >> word;) commands.insert(word);
  return commands;
}

TEST(Readme, SetupTakesItsCommands) {
  const std::set<std::string> known = commandsOfSetup();
  const std::vector<std::string> lines = test::commandsIn(kReadme, "./setup.sh ");
  EXPECT_GE(lines.size(), 2u);
  for (const std::string& line : lines) {
    std::istringstream words(line.substr(11));
    std::string command;
    words >> command;
    EXPECT_EQ(known.count(command), 1u) << line;
  }
}

TEST(Readme, HasNoOtherCommandsThanThoseOfSetup) {
  // A command of a program belongs into Readme_test as soon as README has one.
  EXPECT_TRUE(test::commandsIn(kReadme, "perception-").empty());
  EXPECT_TRUE(test::commandsIn(kReadme, "build/").empty());
}

// ./setup.sh demo builds, and then runs this program; pictures are those of Snapshot_test.
TEST(Readme, TheDemoWritesTheFilesOfItsTableAndFiveFigures) {
  const test::TemporaryFolder folder;
  const std::string snapshot = folder / "perception-snapshot", out = folder / "demo";
  std::ofstream(snapshot) << "#!/bin/sh\nexit 69\n";  // as on a machine without OpenGL
  fs::permissions(snapshot, fs::perms::owner_all);
  const char* path = std::getenv("PATH");
  const CommandOutput demo =
      test::outputOf({"env", "PERCEPTION_DATA=" PERCEPTION_SOURCE_DIR,
                      "PATH=" + folder.path() +
                          ":" PERCEPTION_BINARY_DIR "/bin:" + (path ? path : "/usr/bin:/bin"),
                      PERCEPTION_SOURCE_DIR "/apps/perception-demo/perception-demo", out});
  ASSERT_EQ(demo.code, 0) << demo.text;
  for (const char* figure :
       {"objects", "tracked fraction", "correct class", "id switches", "real-time factor"})
    EXPECT_NE(demo.text.find(std::string("\n") + figure + " "), std::string::npos) << figure;
  const std::string readme = wholeText(kReadme);
  for (const std::string file :
       {"index.html", "tracks.csv", "scenes.csv", "evaluation/", "effective.ini"}) {
    EXPECT_NE(readme.find("| `" + file + "` |"), std::string::npos) << file;
    EXPECT_TRUE(fs::exists(out + "/" + file)) << file;
  }
}

}  // namespace
}  // namespace perception
