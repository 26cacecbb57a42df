// The same drive as recordings of ROS that programs of others have written, and as KITTI has it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/importers/ImportFixture.h"
#include "tests/support/CommandOutput.h"

namespace perception {
namespace {

using test::outputOf;
using test::sharedData;

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, which has its packages
constexpr int kWrittenScans = 20;

class RosWriters : public test::ImportRun {
 protected:
  const std::string scans_ = sharedData("kitti_lidar_seq0000/velodyne_front120");
  const std::string poses_ = sharedData("kitti_tracking/velo_poses/0000.txt");

  void importWritten(const std::string& ending) {
    const std::string recording = file("drive." + ending);
    const auto written =
        outputOf({kPython, "-B", PERCEPTION_SOURCE_DIR "/tests/importers/bags/write_recording.py",
                  scans_, poses_, recording, std::to_string(kWrittenScans)});
    ASSERT_EQ(written.code, 0) << written.text;
    std::filesystem::remove(file("out.rawlog"));
    ASSERT_EQ(import("bag", {"--bag", recording}), 0) << error_;
    EXPECT_EQ(result_.scans, kWrittenScans);
    EXPECT_EQ(result_.poses, kWrittenScans);
  }
  std::string bytesIn(const std::string& name) const {
    std::ifstream in(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(RosWriters, ARecordingByRosbagGivesTheTracksOfKitti) {
  NEEDS_SHARED_DATA("kitti_lidar_seq0000");
  if (outputOf({kPython, "-c", "import rosbag, sensor_msgs.msg, tf2_msgs.msg"}).code != 0)
    GTEST_SKIP() << "no python3-rosbag, python3-sensor-msgs and python3-tf2-msgs";
  importWritten("bag");
  track("kitti.ini", "L");
  const std::string ours = bytesIn("run/tracks.csv");
  std::filesystem::remove(file("out.rawlog"));
  ASSERT_EQ(
      import("kitti", {"--calib", sharedData("kitti_tracking/calib/0000.txt"), "--lidar", scans_,
                       "--poses", poses_, "--last", std::to_string(kWrittenScans - 1)}),
      0)
      << error_;
  track("kitti.ini", "L");
  EXPECT_EQ(ours, bytesIn("run/tracks.csv"));
  EXPECT_GT(std::count(ours.begin(), ours.end(), '\n'), 20) << "rows of tracks";
}

TEST_F(RosWriters, AnMcapAndADatabaseByOthersGiveTheSameLog) {
  NEEDS_SHARED_DATA("kitti_lidar_seq0000");
  if (outputOf({kPython, "-c", "import sqlite3"}).code != 0) GTEST_SKIP() << "no python3";
  importWritten("mcap");
  const std::string log = bytesIn("out.rawlog");
  importWritten("db3");
  EXPECT_EQ(log, bytesIn("out.rawlog"));
  if (outputOf({kPython, "-c", "import rosbag, sensor_msgs.msg, tf2_msgs.msg"}).code != 0)
    GTEST_SKIP() << "the same with a .bag: no python3-rosbag";
  importWritten("bag");
  EXPECT_EQ(log, bytesIn("out.rawlog"));
}

}  // namespace
}  // namespace perception
