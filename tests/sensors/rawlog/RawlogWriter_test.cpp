#include "libperception/sensors/rawlog/RawlogWriter.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "libperception/core/Error.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

std::size_t filesIn(const TemporaryFolder& folder) {
  const std::filesystem::directory_iterator files(folder.path());
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(RawlogWriter, SameObservationsGiveTheSameBytes) {
  TemporaryFolder folder;
  writeLog(folder / "a", 3);
  writeLog(folder / "b", 3);
  EXPECT_EQ(readBytes(folder / "a"), readBytes(folder / "b"));
  EXPECT_EQ(filesIn(folder), 2U);
}

TEST(RawlogWriter, NothingRemainsWithoutClose) {
  TemporaryFolder folder;
  {
    RawlogWriter log(folder / "a");
    log.write(*fullScan(1000));
  }
  EXPECT_EQ(filesIn(folder), 0U);
}

TEST(RawlogWriter, AnOldFileStaysUntilTheNewOneIsWhole) {
  TemporaryFolder folder;
  writeBytes(folder / "a", "old");
  RawlogWriter log(folder / "a");
  log.write(*fullScan(10));
  EXPECT_EQ(readBytes(folder / "a"), "old");
  log.close();
  RawlogReader reader(folder / "a");
  EXPECT_EQ(drain(reader), 1U);
}

TEST(RawlogWriter, CannotCreateIsSaidAtOnce) {
  TemporaryFolder folder;
  for (const std::string& path : {folder / "none/a.rawlog", folder.path()}) {
    try {
      RawlogWriter log(path);
      FAIL() << path;
    } catch (const OutputError& e) {
      EXPECT_EQ(e.code(), ExitCode::kCannotCreate);
      EXPECT_NE(std::string(e.what()).find(folder.path()), std::string::npos);
    }
  }
}

/// A limit on the size of files, as a full disk would set.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

TEST(RawlogWriter, AFullDiskIsAnErrorWhereverItHappens) {
  TemporaryFolder folder;
  writeLog(folder / "whole", 3, 0);
  const std::size_t size = readBytes(folder / "whole").size();
  ASSERT_GT(size, 10000U);
  for (std::size_t room = 0; room < size; room += size / 23) {
    const FullDisk disk(room);
    try {
      writeLog(folder / "cut", 3, 0);
      ADD_FAILURE() << "no error with room for " << room << " of " << size << " bytes";
    } catch (const OutputError& e) {
      EXPECT_EQ(e.code(), ExitCode::kIoError);
      EXPECT_NE(std::string(e.what()).find("cut"), std::string::npos);
    }
    EXPECT_EQ(filesIn(folder), 1U) << room;
  }
}

TEST(RawlogWriter, CountsEntriesAndBytes) {
  TemporaryFolder folder;
  RawlogWriter log(folder / "a");
  for (int i = 0; i < 4; ++i) log.write(*fullScan(500));
  log.close();
  EXPECT_EQ(log.entries(), 4U);
  EXPECT_EQ(log.bytes(), std::filesystem::file_size(folder / "a"));
  EXPECT_GT(log.bytesInflated(), 4 * 500 * 28U);
}

}  // namespace
}  // namespace perception
