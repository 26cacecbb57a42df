// Recordings whose returns were moved into a frame of the world.
#include "libperception/importers/bags/MoveReturns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/importers/clouds/ImportClouds.h"
#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

/// The vehicle's pose in the fixed frame, `t` [s] after the beginning.
Pose3 placeAt(double t) { return makePose(100 + kDriven * t, -40, 0.4, 0.3 + 0.2 * t); }

Planned transformPlan(double t, const std::string& world) {
  return {t, t, "/tf",
          [=](Stamp stamp) {
            ros::TFMessage message;
            message.transforms.push_back({{stamp, world}, "base_link", ros::messageOf(placeAt(t))});
            return ros::encoded(message, ros::Encoding::kCdr);
          },
          "tf2_msgs/msg/TFMessage"};
}

Planned odometryPlan(double t, const std::string& world) {
  return {t, t, "/odom",
          [=](Stamp stamp) {
            ros::Odometry message;
            message.header = {stamp, world}, message.child_frame_id = "base_link";
            message.pose = ros::messageOf(placeAt(t));
            return ros::encoded(message, ros::Encoding::kCdr);
          },
          "nav_msgs/msg/Odometry"};
}

/// The scan as seen from the vehicle, in the fixed frame.
Planned worldScan(int k, const std::string& world) {
  const double t = k * kScanPeriod;
  return {t, t, "/points",
          [=](Stamp stamp) { return cloudBytes(inFrame(oneTurn(k), placeAt(t)), stamp, world); }};
}

class MoveReturns : public OddRecording {
 protected:
  void expectMovedBack(const std::vector<SensorFrame>& frames, const Pose3& T_ego_sensor) {
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(kDriveScans));
    for (int k = 0; k < kDriveScans; ++k) {
      const SensorFrame& frame = frames[static_cast<std::size_t>(k)];
      EXPECT_TRUE(frame.T_ego_sensor.isApprox(T_ego_sensor, 1e-6)) << k;
      EXPECT_TRUE(frame.ego.T_world_ego.isApprox(placeAt(k * kScanPeriod), 1e-4)) << k;
      const LidarCloud got = inFrame(std::get<LidarCloud>(frame.data), T_ego_sensor);
      const LidarCloud expected = oneTurn(k);
      ASSERT_EQ(got.size(), expected.size());
      for (std::size_t i = 0; i < got.size(); i += 17) {
        EXPECT_NEAR(got.x[i], expected.x[i], 1e-3);
        EXPECT_NEAR(got.y[i], expected.y[i], 1e-3);
        EXPECT_NEAR(got.z[i], expected.z[i], 1e-3);
      }
    }
  }
};

TEST_F(MoveReturns, ScansInAFrameOfTransformsAreMovedBackToTheVehicle) {
  std::vector<Planned> plan;
  for (int k = 0; k < kDriveScans; ++k) {
    plan.push_back(transformPlan(k * kScanPeriod, "odom"));
    plan.push_back(worldScan(k, "odom"));
  }
  importOf(plan, 3);
  expectSaid("/points: its returns are in the fixed frame \"odom\": moved back to the vehicle");
  expectSaid("taken to be at \"base_link\" ([topic./points] pose says where it is)");
  expectMovedBack(framesOf("points"), Pose3::Identity());

  write("bag.ini", "[topic./points]\npose = 0.5, 0, 1.8, 90, 0, 0\n");
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap"), "-c", file("bag.ini")}), 0) << error_;
  expectMovedBack(framesOf("points"), makePose(0.5, 0, 1.8, radians(90)));
}

TEST_F(MoveReturns, ScansInTheFrameOfATopicOfPosesToo) {
  for (const std::string world : {"camera_init", "map"}) {
    std::vector<Planned> plan = {mountPlan("imu", 0.2)};
    for (int k = 0; k < kDriveScans; ++k) {
      plan.push_back(odometryPlan(k * kScanPeriod, world));
      plan.push_back(worldScan(k, "/" + world));
    }
    importOf(plan, 3);
    expectSaid("moved back to the vehicle by its poses");
    expectMovedBack(framesOf("points"), Pose3::Identity());
  }
}

TEST_F(MoveReturns, AFrameOfTheWorldThatNoPosesLeadToIsRefused) {
  for (const bool poses : {true, false}) {
    std::vector<Planned> plan;
    for (int k = 0; k < kDriveScans; ++k) {
      if (poses) plan.push_back(transformPlan(k * kScanPeriod, "odom"));
      plan.push_back(worldScan(k, "map"));
    }
    importOf(plan, 65);
    expectSaid("it is in the fixed frame \"map\", in which the pose of the vehicle");
    expectSaid("[topic./points] pose");
  }
}

TEST_F(MoveReturns, ScansWithoutAPoseAtTheirTimeAreLeftOutAndCounted) {
  std::vector<Planned> plan;
  for (int k = 0; k < kDriveScans; ++k) {
    if (k <= 10) plan.push_back(transformPlan(k * kScanPeriod, "odom"));
    plan.push_back(worldScan(k, "odom"));
  }
  importOf(plan, 3);
  expectSaid("/points: 7 unreadable messages left out, the first: ");
  EXPECT_EQ(framesOf("points").size(), 13U);
}

TEST_F(MoveReturns, ALidarInItsOwnFrameKeepsItsPlace) {
  const auto same = [](double t) { return t; };
  importOf(drive(same, same), 0);
  EXPECT_NEAR(framesOf("points").at(3).T_ego_sensor.translation().x(), 0.5, 1e-9);
}

TEST(MoveReturnsOf, ReturnsOfARadarKeepTheirRates) {
  SensorFrame frame;
  RadarReturns radar;
  RadarReturn flat, high;
  flat.range = 10, flat.bearing = radians(90), flat.range_rate = -3;
  high.range = 10, high.elevation = radians(90);
  radar.returns = {flat, high};
  frame.data = radar;
  moveReturns(makePose(5, 0, 1, 0), frame);
  const auto& moved = std::get<RadarReturns>(frame.data).returns;
  EXPECT_NEAR(moved[0].range, std::sqrt(25 + 100 + 1), 1e-9);
  EXPECT_NEAR(moved[0].bearing, std::atan2(10, 5), 1e-9);
  EXPECT_FALSE(moved[0].elevation);
  EXPECT_EQ(moved[0].range_rate, -3);
  EXPECT_NEAR(*moved[1].elevation, std::atan2(11, 5), 1e-9);
}

}  // namespace
}  // namespace perception
