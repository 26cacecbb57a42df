#include "libperception/capture/ChunkedLog.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <random>
#include <thread>

#include "libperception/core/Error.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

mrpt::obs::CObservationComment commentOf(std::size_t size) {
  mrpt::obs::CObservationComment comment;
  comment.timestamp = mrpt::Clock::now();
  std::minstd_rand random(1);
  for (std::size_t i = 0; i < size; ++i) comment.text += static_cast<char>('!' + random() % 90);
  return comment;
}

TEST(ChunkedLog, AKilledCaptureLeavesWholeChunksOnly) {
  const std::string dir = testing::TempDir() + "/chunked";
  const auto comment = commentOf(20000);
  std::minstd_rand random(2);
  std::uint64_t whole = 0;
  for (int i = 0; i < 8; ++i) {
    fs::remove_all(dir);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ChunkedLog log(dir, {60, 100000, 0});
      for (;;) {
        log.write(comment);
        log.tend();
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(150 + random() % 150));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    for (const auto& entry : fs::directory_iterator(dir)) {
      if (entry.path().extension() != ".rawlog") continue;
      RawlogReader reader(entry.path().string());
      while (reader.next()) {
      }
      EXPECT_EQ(reader.end(), RawlogReader::End::kClean) << entry.path();
      ++whole;
    }
  }
  EXPECT_GT(whole, 0U);
  fs::remove_all(dir);
}

TEST(ChunkedLog, DoesNotMixTwoCaptures) {
  const std::string dir = testing::TempDir() + "/two captures";
  fs::remove_all(dir);
  {
    ChunkedLog log(dir, {60, 1000000, 0});
    log.write(commentOf(10));
    log.close();
  }
  EXPECT_THROW(ChunkedLog(dir, {}), OutputError);
  fs::remove_all(dir);
}

}  // namespace
}  // namespace perception
