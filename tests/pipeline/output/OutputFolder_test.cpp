#include "libperception/pipeline/output/OutputFolder.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/scene/files/OutputFile.h"
#include "tests/support/TemporaryFolder.h"

namespace {

/// Files and folders handed to disk, in the order of the calls.
std::vector<std::string> synced;

}  // namespace

// In place of the C library's.
extern "C" int fsync(int file) {
  synced.push_back(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file)));
  return static_cast<int>(::syscall(SYS_fsync, file));
}

namespace perception::test {
namespace {

namespace fs = std::filesystem;

void putText(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string textOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::vector<std::string> namesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// Exit code and message of what making the folder throws; 0 when it does not.
std::pair<int, std::string> failureOf(const std::string& path) {
  try {
    OutputFolder folder(path);
  } catch (const Error& error) {
    return {static_cast<int>(error.code()), error.what()};
  }
  return {0, ""};
}

using Names = std::vector<std::string>;

TEST(OutputFolder, FilesAppearTogetherAtCommit) {
  const TemporaryFolder base;
  OutputFolder folder(base / "a/b/out/");
  EXPECT_EQ(folder.path(), base / "a/b/out");
  putText(folder.pathFor("tracks.csv"), "t");
  putText(folder.pathFor("plots/range.png"), "p");
  putText(folder.pathFor("done.json"), "d");
  EXPECT_EQ(namesIn(folder.path()).size(), 1u);  // the hidden one
  folder.commit();
  EXPECT_EQ(namesIn(folder.path()), (Names{"done.json", "plots", "tracks.csv"}));
  EXPECT_EQ(textOf(folder.path() + "/plots/range.png"), "p");
}

TEST(OutputFolder, FilesAreOnDiskBeforeTheyHaveTheirNamesAndNamesBeforeDone) {
  const TemporaryFolder base;
  const std::string out = fs::canonical(base.path()) / "out";
  for (const bool again : {false, true}) {
    OutputFolder folder(out);
    synced.clear();
    for (const char* name : {"tracks.csv", "done.json"}) writeFile(folder.pathFor(name), "x");
    EXPECT_EQ(synced, Names{}) << "commit() does it";
    Names expected{folder.temporary() + "/tracks.csv", folder.temporary() + "/done.json", out, out};
    if (again) expected.push_back(out);  // without the done.json of before
    folder.commit();
    EXPECT_EQ(synced, expected);
  }
  synced.clear();
  writeFile(out + "/alone.txt", "x");
  ASSERT_EQ(synced.size(), 2u);
  EXPECT_NE(synced[0].find("alone.txt"), std::string::npos);
  EXPECT_EQ(synced[1], out);
}

TEST(OutputFolder, WithoutCommitNothingIsLeft) {
  const TemporaryFolder base;
  {
    OutputFolder folder(base / "a/b");
    putText(folder.pathFor("tracks.csv"), "t");
  }
  EXPECT_EQ(namesIn(base.path()), Names{});
}

TEST(OutputFolder, WithoutCommitAnEarlierResultStays) {
  const TemporaryFolder base;
  fs::create_directories(base / "out");
  putText(base / "out/done.json", "old");
  {
    OutputFolder folder(base / "out");
    putText(folder.pathFor("done.json"), "new");
  }
  EXPECT_EQ(namesIn(base / "out"), Names{"done.json"});
  EXPECT_EQ(textOf(base / "out/done.json"), "old");
}

TEST(OutputFolder, AnEarlierResultIsReplacedFileByFile) {
  const TemporaryFolder base;
  fs::create_directories(base / "out");
  for (const char* name : {"done.json", "tracks.csv", "notes.txt"})
    putText(base / "out/" + name, "old");
  OutputFolder folder(base / "out");
  putText(folder.pathFor("tracks.csv"), "new");
  putText(folder.pathFor("done.json"), "new");
  folder.commit();
  EXPECT_EQ(namesIn(folder.path()), (Names{"done.json", "notes.txt", "tracks.csv"}));
  EXPECT_EQ(textOf(base / "out/tracks.csv"), "new");
  EXPECT_EQ(textOf(base / "out/done.json"), "new");
  EXPECT_EQ(textOf(base / "out/notes.txt"), "old");
}

TEST(OutputFolder, AnInterruptedCommitLeavesNoDoneFile) {
  const TemporaryFolder base;
  fs::create_directories(base / "out/tracks.csv");  // a folder in the way of the file
  putText(base / "out/tracks.csv/x", "");
  putText(base / "out/done.json", "old");
  {
    OutputFolder folder(base / "out");
    putText(folder.pathFor("done.json"), "new");
    putText(folder.pathFor("tracks.csv"), "new");
    try {
      folder.commit();
      FAIL() << "a file cannot replace a folder";
    } catch (const OutputError& error) {
      EXPECT_EQ(error.code(), ExitCode::kIoError);
      EXPECT_NE(std::string(error.what()).find(base / "out/tracks.csv: cannot be written: "),
                std::string::npos);
    }
  }
  EXPECT_EQ(namesIn(base / "out"), Names{"tracks.csv"});
}

TEST(OutputFolder, APromisedFileThatWasNeverWrittenIsAnError) {
  const TemporaryFolder base;
  OutputFolder folder(base / "out");
  folder.pathFor("tracks.csv");
  EXPECT_THROW(folder.commit(), OutputError);
}

TEST(OutputFolder, CannotBeCreatedSaysWhy) {
  const TemporaryFolder base;
  putText(base / "file", "");
  EXPECT_EQ(
      failureOf(base / "file"),
      std::pair(73, (base / "file") +
                        ": cannot be created: a file of that name is there, expected a folder"));
  EXPECT_EQ(failureOf(base / "file/out"),
            std::pair(73, (base / "file/out") + ": cannot be created: " + (base / "file") +
                              " is not a folder"));
  EXPECT_EQ(failureOf("").first, 73);
  const auto too_long = failureOf(base / (std::string(300, 'x') + "/out"));
  EXPECT_EQ(too_long.first, 73);
  EXPECT_NE(too_long.second.find("File name too long"), std::string::npos);
  const auto denied = failureOf("/proc/none/out");
  EXPECT_EQ(denied.first, 73);
  EXPECT_NE(denied.second.find("/proc/none/out: cannot be created: "), std::string::npos);
  EXPECT_EQ(namesIn(base.path()), Names{"file"});
}

TEST(OutputFolder, TakesBackTheParentsItMadeWhenTheRestFails) {
  const TemporaryFolder base;
  EXPECT_EQ(failureOf(base / ("a/b/" + std::string(300, 'x'))).first, 73);
  EXPECT_EQ(namesIn(base.path()), Names{});
}

TEST(OutputFolder, ASecondRunFindsItBusyAndHarmsNothing) {
  const TemporaryFolder base;
  OutputFolder folder(base / "out");
  putText(folder.pathFor("done.json"), "first");
  EXPECT_EQ(failureOf(base / "out"),
            std::pair(75, (base / "out") + ": busy: another run writes into it"));
  folder.commit();
  EXPECT_EQ(textOf(base / "out/done.json"), "first");
  EXPECT_EQ(failureOf(base / "out").first, 0);  // free again
}

TEST(OutputFolder, LeftoversOfKilledRunsOfThisHostGoAway) {
  const TemporaryFolder base;
  char host[256] = {};
  ASSERT_EQ(::gethostname(host, sizeof host - 1), 0);
  const std::string of_dead = base / ("out/.unfinished." + std::string(host) + ".999999999");
  const std::string of_other = base / "out/.unfinished.elsewhere.5";
  fs::create_directories(of_dead);
  fs::create_directories(of_other);
  putText(of_dead + "/tracks.csv", "half");
  EXPECT_EQ(failureOf(base / "out").first, 0);
  EXPECT_EQ(namesIn(base / "out"), Names{".unfinished.elsewhere.5"});
}

TEST(OutputFolder, NamesStayInside) {
  const TemporaryFolder base;
  OutputFolder folder(base / "out");
  for (const char* name : {"", "../x", "a/../../x", "/x"})
    EXPECT_THROW(folder.pathFor(name), OutputError) << name;
}

TEST(OutputFolder, PathsMayHoldSpacesAndUmlauts) {
  const TemporaryFolder base;
  OutputFolder folder(base / "m\xC3\xBC ll");
  putText(folder.pathFor("done.json"), "d");
  folder.commit();
  EXPECT_EQ(textOf(base / "m\xC3\xBC ll/done.json"), "d");
}

}  // namespace
}  // namespace perception::test
