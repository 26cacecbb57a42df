#include "libperception/importers/TopicChecks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace perception {
namespace {

SensorFrame scanAt(double seconds, std::vector<float> times = {}) {
  LidarCloud cloud;
  cloud.x = {1, 2}, cloud.y = {0, 0}, cloud.z = {0, 0};
  cloud.time_offset = std::move(times);
  SensorFrame frame;
  frame.sensor = "LIDAR";
  frame.stamp = Stamp::fromSeconds(seconds);
  frame.data = std::move(cloud);
  return frame;
}

/// Scans at these seconds on one topic; how many of them are taken.
int takenOf(TopicChecks& checks, const std::vector<double>& seconds) {
  int taken = 0;
  for (const double t : seconds) {
    SensorFrame frame = scanAt(t);
    taken += checks.take("/points", "lidar", frame) ? 1 : 0;
  }
  return taken;
}

TEST(TopicChecks, TakeARecordingInOrder) {
  TopicChecks checks;
  EXPECT_EQ(takenOf(checks, {10, 10.1, 10.2, 10.3}), 4);
  EXPECT_TRUE(checks.warnings().empty());
}

TEST(TopicChecks, TakeMessagesThatComeALittleOutOfOrder) {
  TopicChecks checks;
  EXPECT_EQ(takenOf(checks, {10, 10.2, 10.1, 10.3}), 4);
  EXPECT_TRUE(checks.warnings().empty());
}

TEST(TopicChecks, LeaveOutWhatLiesBeforeAJumpBack) {
  TopicChecks checks;
  EXPECT_EQ(takenOf(checks, {10, 10.5, 11, 10.25, 10.75, 11.25}), 4);
  EXPECT_EQ(checks.warnings(),
            (std::vector<std::string>{
                "/points: time jumps back by 0.750 s at message 4; 2 messages that lie before what "
                "was there already are left out"}));
}

TEST(TopicChecks, TopicsHaveTheirOwnTimes) {
  TopicChecks checks;
  SensorFrame a = scanAt(100), b = scanAt(5);
  EXPECT_TRUE(checks.take("/a", "lidar", a));
  EXPECT_TRUE(checks.take("/b", "lidar", b));
  EXPECT_TRUE(checks.warnings().empty());
}

TEST(TopicChecks, TwoFramesOfReferenceAreTwoSensors) {
  TopicChecks checks;
  SensorFrame front = scanAt(10), rear = scanAt(10), next = scanAt(10.1);
  EXPECT_TRUE(checks.take("/points", "front", front));
  EXPECT_TRUE(checks.take("/points", "rear/lidar", rear));
  EXPECT_TRUE(checks.take("/points", "front", next));
  EXPECT_EQ(front.sensor, "LIDAR");
  EXPECT_EQ(rear.sensor, "LIDAR_rear_lidar");
  EXPECT_EQ(next.sensor, "LIDAR");
  EXPECT_TRUE(checks.isFirstReference("/points", "front"));
  EXPECT_FALSE(checks.isFirstReference("/points", "rear/lidar"));
  ASSERT_EQ(checks.warnings().size(), 1U);
  EXPECT_NE(checks.warnings()[0].find("\"front\" and \"rear/lidar\""), std::string::npos);
}

TEST(TopicChecks, TimesOfReturnsWithinTheScanStay) {
  TopicChecks checks;
  SensorFrame frame = scanAt(10, {0, 0.1F});
  EXPECT_TRUE(checks.take("/points", "lidar", frame));
  EXPECT_EQ(std::get<LidarCloud>(frame.data).time_offset.size(), 2U);
}

TEST(TopicChecks, TimesOfReturnsSecondsOutsideOfTheScanAreLeftOut) {
  TopicChecks checks;
  SensorFrame frame = scanAt(10, {0, 7});
  EXPECT_TRUE(checks.take("/points", "lidar", frame));
  EXPECT_TRUE(std::get<LidarCloud>(frame.data).time_offset.empty());
  EXPECT_EQ(checks.warnings(),
            (std::vector<std::string>{"/points: 1 scans have returns that are timed up to 7.0 s "
                                      "outside of them: the times of their returns are left out"}));
}

TEST(TopicChecks, TimesThatAreNoNumbersAreLeftOutToo) {
  TopicChecks checks;
  SensorFrame frame = scanAt(10, {0, std::nanf("")});
  EXPECT_TRUE(checks.take("/points", "lidar", frame));
  EXPECT_TRUE(std::get<LidarCloud>(frame.data).time_offset.empty());
}

}  // namespace
}  // namespace perception
