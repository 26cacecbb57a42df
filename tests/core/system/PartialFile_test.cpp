#include "libperception/core/system/PartialFile.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

namespace fs = std::filesystem;

std::set<std::string> namesIn(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(PartialFile, HasItsNameOnceItIsComplete) {
  const TemporaryFolder folder;
  {
    PartialFile file(folder / "a.csv");
    std::ofstream(file.path()) << "whole";
    EXPECT_FALSE(fs::exists(folder / "a.csv"));
    file.commit();
    EXPECT_EQ(namesIn(folder.path()), std::set<std::string>{"a.csv"});
  }
  {
    PartialFile file(folder / "a.csv");
    std::ofstream(file.path()) << "half";
  }
  EXPECT_EQ(namesIn(folder.path()), std::set<std::string>{"a.csv"});
  std::string text;
  std::ifstream(folder / "a.csv") >> text;
  EXPECT_EQ(text, "whole");
}

TEST(PartialFile, ThatOfAKilledProcessIsRemovedByTheNextOne) {
  const TemporaryFolder folder;
  const pid_t process = ::fork();
  if (process == 0) {
    PartialFile file(folder / "a.csv");
    std::ofstream(file.path()) << "half";
    ::raise(SIGKILL);
  }
  ::waitpid(process, nullptr, 0);
  std::ofstream(folder / ".other.part") << "without a process";
  ASSERT_EQ(namesIn(folder.path()).size(), 2U);
  const PartialFile file(folder / "b.csv");
  EXPECT_EQ(namesIn(folder.path()), std::set<std::string>{".other.part"});
}

TEST(PartialFile, WhoeverHasEndedIsNotAliveEvenIfNobodyWaits) {
  const pid_t process = ::fork();
  if (process == 0) ::_exit(0);
  siginfo_t info{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOWAIT), 0);
  EXPECT_EQ(::kill(process, 0), 0) << "its number is in use";
  EXPECT_FALSE(isAlive(process));
  EXPECT_TRUE(isAlive(::getpid()));
  ::waitpid(process, nullptr, 0);
}

TEST(PartialFile, ADeviceIsWrittenToAsItIs) {
  EXPECT_EQ(PartialFile("/dev/null").path(), "/dev/null");
}

TEST(Irregularity, APipeIsRefusedAndNotWaitedFor) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(irregularity(folder / "pipe"), "a pipe");
  EXPECT_EQ(irregularity(folder.path()), "a directory");
  EXPECT_EQ(irregularity("/dev/null"), "a device");
  EXPECT_EQ(irregularity(folder / "none"), "");
  EXPECT_THROW(CsvTable::fromFile(folder / "pipe"), DataError);
  EXPECT_THROW(readGroundTruth(folder / "pipe"), DataError);
}

}  // namespace
}  // namespace perception::test
