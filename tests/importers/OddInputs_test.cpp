// Clocks that jump or differ, points of other times than their scan, two sensors on one topic.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/interop/ros/RosDevices.h"
#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

class OddInputs : public OddRecording {};

double same(double t) { return t; }

/// Two returns, with fields named as some drivers do, and times since 1970.
std::string timedCloudBytes(Stamp stamp, double unit) {
  std::string data;
  for (int i = 0; i < 2; ++i) {
    const float place[] = {3, 4, 5, 0.5F};
    const double time = (stamp.seconds() + 0.05 * i) / unit;
    data.append(reinterpret_cast<const char*>(place), sizeof(place));
    data.append(reinterpret_cast<const char*>(&time), sizeof(time));
  }
  ros::PointCloud2 message;
  message.header = {stamp, "velodyne"};
  message.width = 2, message.point_step = 24, message.row_step = 48, message.data = data;
  const auto type = ros::PointField::kF32;
  message.point_fields = {{"X", 0, type, 1},
                          {"Y", 4, type, 1},
                          {"Z", 8, type, 1},
                          {"Intensity", 12, type, 0},
                          {"timestamp", 16, ros::PointField::kF64, 1}};
  return ros::encoded(message, ros::Encoding::kCdr);
}

TEST_F(OddInputs, ATimeThatJumpsBackByHalfASecondLosesWhatItRepeats) {
  const auto jumps = [](double t) { return t < 0.99 ? t : t - 0.5; };
  importOf(drive(jumps, jumps), 3);
  const auto times = timesOf("points");
  EXPECT_EQ(times.size(), 15U);  // 10, then from the first that is newer on
  expectRising(times);
  expectSaid("/points: the time of its messages jumps, by up to 0.400 s: 5 of 20 left out");
  expectSaid("transforms of \"base_link\": the time of its messages jumps");
}

TEST_F(OddInputs, ATimeThatJumpsBackByFiveSecondsEndsTheLogThere) {
  const auto jumps = [](double t) { return t < 1.19 ? t : t - 5; };
  importOf(drive(jumps, jumps), 3);
  const auto frames = framesOf("points");
  EXPECT_EQ(frames.size(), 12U);
  expectPlaces(frames);
  expectSaid("by up to 4.900 s");
  expectSaid("8 of 20 left out");
}

TEST_F(OddInputs, ARecorderWhoseOwnClockJumpsBackTooIsTheSame) {
  auto plan = drive(same, same);
  for (Planned& p : plan) {
    if (p.recorded > 0.99) p.recorded -= 0.5, p.measured -= 0.5;
  }
  importOf(plan, 3);
  expectRising(timesOf("points"));
  expectSaid("5 of 20 left out");
}

TEST_F(OddInputs, OneScanThatWasRecordedLateIsPutIntoItsPlace) {
  auto plan = drive(same, same);
  std::swap(plan[10], plan[12]);  // two scans
  std::swap(plan[10].recorded, plan[12].recorded);
  importOf(plan, 0);
  const auto times = timesOf("points");
  EXPECT_EQ(times.size(), 20U);
  expectRising(times);
}

TEST_F(OddInputs, AStampOfTheFarFutureIsLeftOutAlone) {
  auto plan = drive(same, same);
  plan[10].measured = 1e6;
  importOf(plan, 3);
  EXPECT_EQ(timesOf("points").size(), 19U);
  expectSaid("1 of 20 left out");
}

TEST_F(OddInputs, AClockThatIsSetForwardOnceStaysSet) {
  const auto jumps = [](double t) { return t < 0.99 ? t - 1000 : t; };
  importOf(drive(jumps, jumps), 0);
  EXPECT_EQ(result_.scans, 20);
}

TEST_F(OddInputs, PointsFiveSecondsOutsideOfTheirScanHaveNoTimes) {
  auto plan = drive(same, same);
  for (Planned& p : plan) {
    if (p.topic == "/points")
      p.bytes = [](Stamp stamp) { return cloudBytes(oneTurn(0, 1, 5), stamp, "velodyne"); };
  }
  importOf(plan, 3);
  for (const SensorFrame& frame : framesOf("points"))
    EXPECT_TRUE(std::get<LidarCloud>(frame.data).time_offset.empty());
  expectSaid("points: returns lie more than 1.05 s outside of 20 of its scans");
}

TEST_F(OddInputs, PointsWithTimesInMicrosecondsOrSince1970HaveNoTimes) {
  for (const auto& [unit, start] : {std::pair(1e6, 0.0), std::pair(1.0, 1.7e9)}) {
    auto plan = drive(same, same);
    for (Planned& p : plan) {
      if (p.topic == "/points")
        p.bytes = [u = unit, s = start](Stamp stamp) {
          return cloudBytes(oneTurn(0, u, s), stamp, "velodyne");
        };
    }
    importOf(plan, 3);
    EXPECT_EQ(result_.scans, 20);
    expectSaid("outside of 20 of its scans");
    std::filesystem::remove(file("out.rawlog"));
  }
}

TEST_F(OddInputs, ScansWithinASecondKeepTheirTimes) {
  auto plan = drive(same, same);
  for (Planned& p : plan) {
    if (p.topic == "/points")
      p.bytes = [](Stamp stamp) { return cloudBytes(oneTurn(0, 1, -0.1), stamp, "velodyne"); };
  }
  importOf(plan, 0);
  EXPECT_EQ(std::get<LidarCloud>(framesOf("points").at(0).data).time_offset.size(), 720U);
}

TEST_F(OddInputs, TimesSince1970InSecondsAndNanosecondsAreOfTheScan) {
  for (const double unit : {1.0, 1e-9}) {
    auto plan = drive(same, same);
    for (Planned& p : plan) {
      if (p.topic != "/points") continue;
      p.bytes = [unit](Stamp stamp) { return timedCloudBytes(stamp, unit); };
    }
    std::filesystem::remove(file("out.rawlog"));
    importOf(plan, 0);
    const auto frames = framesOf("points");
    ASSERT_EQ(frames.size(), 20U);
    const auto& cloud = std::get<LidarCloud>(frames[3].data);
    ASSERT_EQ(cloud.time_offset.size(), 2U);
    EXPECT_NEAR(cloud.time_offset[1] - cloud.time_offset[0], 0.05, 1e-5);
    EXPECT_EQ(cloud.y[1], 4) << "names in capital letters";
  }
}

TEST_F(OddInputs, AScanWithoutReturnsAndFieldsIsAScan) {
  auto plan = drive(same, same);
  plan[10].bytes = [](Stamp stamp) {
    ros::PointCloud2 message;
    message.header = {stamp, "velodyne"};
    message.height = 0;
    return ros::encoded(message, ros::Encoding::kCdr);
  };
  ASSERT_EQ(plan[10].topic, "/points");
  importOf(plan, 0);
  const auto frames = framesOf("points");
  ASSERT_EQ(frames.size(), 20U);
  EXPECT_EQ(std::get<LidarCloud>(frames[4].data).size(), 0U);
}

TEST_F(OddInputs, ScansThatArePassedOnWithAnotherStampAreDoubles) {
  std::vector<Planned> plan;
  for (const Planned& p : drive(same, same)) {
    plan.push_back(p);
    if (p.topic != "/points") continue;
    plan.push_back(p);
    plan.back().measured += 0.004, plan.back().recorded += 0.004;
  }
  importOf(plan, 0);
  EXPECT_EQ(timesOf("points").size(), 20U);
  EXPECT_EQ(frameNumbers().size(), 20U);
  expectSaid("points: 20 messages came twice");
}

TEST_F(OddInputs, RepetitionsOfAScanThatStandsAreNoDoubles) {
  std::vector<Planned> plan;
  for (int k = 0; k < 5; ++k) {  // as with --repeat: 5 ms apart, the next scan 10 s later
    for (int again = 0; again < 5; ++again)
      plan.push_back(scanPlan(k, 10 * k + 0.005 * again, 10 * k + 0.005 * again, "base_link"));
  }
  importOf(plan, 3);
  EXPECT_EQ(timesOf("points").size(), 25U);
}

TEST_F(OddInputs, TwoFramesOnOneTopicAreTwoSensors) {
  std::vector<Planned> plan = {mountPlan("front", 2), mountPlan("rear", -1)};
  for (int k = 0; k < kDriveScans; ++k) {
    const double t = k * kScanPeriod;
    plan.push_back(posePlan(t, t, kDriven * t));
    plan.push_back(scanPlan(k, t, t, "front"));
    plan.push_back(scanPlan(k, t - 0.02, t + 0.01, "/rear"));
  }
  importOf(plan, 0);
  const auto front = framesOf("points"), rear = framesOf("points_rear");
  ASSERT_EQ(front.size(), 20U);
  ASSERT_EQ(rear.size(), 20U);
  EXPECT_NEAR(front[5].T_ego_sensor.translation().x(), 2, 1e-9);
  EXPECT_NEAR(rear[5].T_ego_sensor.translation().x(), -1, 1e-9);
  EXPECT_EQ(result_.frames, 20) << "the first one's scans are the frames";
  expectSaid("/points: messages in 2 frames (front, rear): taken as a sensor each");
}

TEST_F(OddInputs, AFrameWithAndWithoutItsSlashIsOne) {
  auto plan = drive(same, same);
  for (std::size_t i = 2; i < plan.size(); i += 4) {
    plan[i].bytes = [](Stamp stamp) { return cloudBytes(oneTurn(7), stamp, "/velodyne"); };
  }
  importOf(plan, 0);
  EXPECT_EQ(framesOf("points").size(), 20U);
}

TEST_F(OddInputs, PosesInTwoFramesOfReferenceOnOneTopicAreNotMixed) {
  std::vector<Planned> plan = {mountPlan("velodyne", 0.5)};
  for (int k = 0; k < kDriveScans; ++k) {
    const double t = k * kScanPeriod;
    for (const bool map : {true, false})
      plan.push_back({t, t, "/pose",
                      [=](Stamp stamp) {
                        ros::PoseStamped pose;
                        pose.header = {stamp, map ? "map" : "odom"};
                        pose.pose =
                            ros::messageOf(makePose(kDriven * t + (map ? 0 : 500), 0, 0, 0));
                        return ros::encoded(pose, ros::Encoding::kCdr);
                      },
                      "geometry_msgs/msg/PoseStamped"});
    plan.push_back(scanPlan(k, t, t));
  }
  write("poses.ini", "[bag]\nbase_frame = base_link\n");
  importOf(plan, 3);
  expectPlaces(framesOf("points"));
  expectSaid("/pose: 20 poses are in another frame than \"map\": left out");
}

TEST_F(OddInputs, ARadarWhoseClockIsAYearBehindTakesTheRecordingsTime) {
  auto plan = drive(same, same);
  for (int k = 0; k < kDriveScans; ++k) plan.push_back(radarPlan(k * 0.1 - 31'536'000, k * 0.1));
  importOf(plan, 3);
  const auto times = timesOf("radar");
  ASSERT_EQ(times.size(), 20U);
  EXPECT_NEAR(times.front(), 0, 1e-3);
  expectRising(times);
  expectSaid("/radar: its clock is 31536000.000 s behind the recording's");
}

TEST_F(OddInputs, ALidarOnAtomicTimeIsMovedToThePosesTime) {
  importOf(drive([](double t) { return t + 37; }, same), 3);
  const auto frames = framesOf("points");
  EXPECT_EQ(frames.size(), 20U);
  EXPECT_EQ(result_.poses, 20);
  expectPlaces(frames);
  expectSaid("/points: its clock is 37.000 s ahead of the recording's");
}

TEST_F(OddInputs, PosesByAnotherClockAreMovedToTheScansTime) {
  importOf(drive(same, [](double t) { return t - 5; }), 3);
  EXPECT_EQ(result_.poses, 20);
  expectPlaces(framesOf("points"));
  expectSaid("transforms of \"base_link\": its clock is 5.000 s behind");
}

TEST_F(OddInputs, ARecordingOfAReplayKeepsTheStampsOfTheDrive) {
  const auto then = [](double t) { return t - 1e6; };
  importOf(drive(then, then), 0);
  EXPECT_NEAR(timesOf("points").front(), -1e6, 1e-3);
  EXPECT_EQ(result_.poses, 20);
}

TEST_F(OddInputs, MessagesWithoutStampsTakeTheRecordingsTimeAndItIsSaid) {
  auto plan = drive(same, same);
  for (Planned& p : plan) {
    if (p.topic == "/points")
      p.bytes = [](Stamp) { return cloudBytes(oneTurn(0), Stamp{0}, "velodyne"); };
  }
  importOf(plan, 0);
  EXPECT_EQ(timesOf("points").size(), 20U);
  expectSaid("/points: 20 of 20 messages have no stamp: the time of recording is taken");
}

}  // namespace
}  // namespace perception
