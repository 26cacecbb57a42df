#include "libperception/sensors/rawlog/ObservationStream.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

StreamEntry entryOf(double x) {
  auto odometry = std::make_shared<mrpt::obs::CObservationOdometry>();
  odometry->sensorLabel = "WHEELS";
  odometry->odometry.x(x);
  return {odometry, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(1234567)), 7};
}

/// The reader of a file with two entries, cut to `bytes`.
std::unique_ptr<StreamReader> readerOf(const std::string& path, std::size_t cut) {
  {
    StreamWriter writer(path);
    EXPECT_TRUE(writer.write(entryOf(1)));
    EXPECT_TRUE(writer.write(entryOf(2)));
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - cut);
  return std::make_unique<StreamReader>(::open(path.c_str(), O_RDONLY));
}

TEST(ObservationStream, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const auto reader = readerOf(folder / "stream", 0);
  StreamEntry entry;
  for (const double x : {1.0, 2.0}) {
    ASSERT_EQ(reader->read(entry, 1000), StreamReader::Result::kEntry);
    const auto& odometry = dynamic_cast<const mrpt::obs::CObservationOdometry&>(*entry.observation);
    EXPECT_EQ(odometry.odometry.x(), x);
    EXPECT_EQ(odometry.sensorLabel, "WHEELS");
    EXPECT_EQ(entry.arrival, entryOf(0).arrival);
    EXPECT_EQ(entry.dropped, 7U);
  }
  EXPECT_EQ(reader->read(entry, 1000), StreamReader::Result::kEnd);
  EXPECT_EQ(reader->bytesRead(), std::filesystem::file_size(folder / "stream"));
}

TEST(ObservationStream, AnEndWithinAnEntryIsAFault) {
  const TemporaryFolder folder;
  const auto reader = readerOf(folder / "stream", 5);
  StreamEntry entry;
  EXPECT_EQ(reader->read(entry, 1000), StreamReader::Result::kEntry);
  EXPECT_THROW(reader->read(entry, 1000), std::runtime_error);
}

TEST(ObservationStream, OtherBytesAreAFault) {
  const TemporaryFolder folder;
  const std::string path = folder / "text";
  std::ofstream(path) << std::string(100, 'x');
  StreamReader reader(::open(path.c_str(), O_RDONLY));
  StreamEntry entry;
  EXPECT_THROW(reader.read(entry, 1000), std::runtime_error);
}

TEST(ObservationStream, APipeInWhichNothingComesIsWaitedForAsLongAsAsked) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  StreamReader reader(ends[0]);
  StreamEntry entry;
  EXPECT_EQ(reader.read(entry, 20), StreamReader::Result::kNothing);
  ::close(ends[1]);
  EXPECT_EQ(reader.read(entry, 20), StreamReader::Result::kEnd);
}

}  // namespace
}  // namespace perception::test
