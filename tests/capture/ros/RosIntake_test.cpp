#include "libperception/capture/ros/RosIntake.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include "libperception/core/Error.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosSensors.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"

namespace perception {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

Stamp at(double seconds) { return {static_cast<std::int64_t>(seconds * 1e9) + 1000 * kSecond}; }

std::string cloudAt(double t, const std::string& frame) {
  LidarCloud cloud;
  cloud.x = {5}, cloud.y = {1}, cloud.z = {0.5F + static_cast<float>(t)};
  std::string data;
  return ros::encoded(ros::messageOf(cloud, {at(t), frame}, data), ros::Encoding::kCdr);
}

std::string transformAt(double t, const std::string& parent, const std::string& child, double x) {
  const ros::TFMessage message{{{{at(t), parent}, child, ros::messageOf(makePose(x, 0, 0, 0))}}};
  return ros::encoded(message, ros::Encoding::kCdr);
}

class Graph {
 public:
  explicit Graph(const std::string& ini = "")
      : config_(Config::fromText(ini)),
        intake(config_, [this](std::shared_ptr<mrpt::obs::CObservation> o) { add(*o); }) {}

  void cloud(double t, double received, const std::string& frame = "velodyne") {
    intake.take("/points", "sensor_msgs/PointCloud2", cloudAt(t, frame), at(received));
  }
  void moves(double t, double received, double x = 0) {
    intake.take("/tf", "tf2_msgs/TFMessage", transformAt(t, "map", "base_link", x), at(received));
  }
  void mount(double received) {
    intake.take("/tf_static", "tf2_msgs/TFMessage", transformAt(0, "base_link", "velodyne", 1.5),
                at(received));
  }

  std::string came;  ///< s: scan, p: pose, f: frame number, i: inertial unit
  std::vector<double> poses_x, mounts_x;

 private:
  void add(const mrpt::obs::CObservation& o) {
    if (const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&o)) {
      came += 'p';
      poses_x.push_back(pose->pose.mean.x());
    } else if (const auto* scan = dynamic_cast<const CObservationLidarScan*>(&o)) {
      came += 's';
      mrpt::poses::CPose3D place;
      scan->getSensorPose(place);
      mounts_x.push_back(place.x());
    } else {
      came += dynamic_cast<const mrpt::obs::CObservationComment*>(&o) != nullptr ? 'f' : 'i';
    }
  }
  Config config_;

 public:
  RosIntake intake;
};

TEST(RosIntake, AScanWaitsForItsPlaceOnTheVehicleAndPosesWaitForTheScan) {
  Graph graph;
  graph.cloud(0, 0);
  graph.moves(0, 0.01);
  graph.moves(0.1, 0.11);
  graph.cloud(0.1, 0.12);
  EXPECT_EQ(graph.came, "p") << "a pose later than the scan would make it late";
  graph.mount(0.3);
  EXPECT_EQ(graph.came, "pfspfs");
  EXPECT_EQ(graph.mounts_x, (std::vector<double>{1.5, 1.5}));
}

TEST(RosIntake, WithoutATransformItGoesOnAfterAWhileAndSaysSo) {
  Graph graph("[ros]\npatience = 0.5\n");
  graph.cloud(0, 0);
  graph.intake.tend(at(0.4));
  EXPECT_EQ(graph.came, "");
  graph.intake.tend(at(0.6));
  EXPECT_EQ(graph.came, "fs");
  graph.cloud(0.7, 0.7);
  EXPECT_EQ(graph.came, "fsfs") << "it waits once, not at each scan";
  const auto warnings = graph.intake.warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("\"velodyne\" has no transform"), std::string::npos);
}

TEST(RosIntake, APoseOfAChainWaitsForTheOtherSteps) {
  Graph graph;
  const auto step = [&](const char* parent, const char* child, double t, double x, double now) {
    graph.intake.take("/tf", "tf2_msgs/TFMessage", transformAt(t, parent, child, x), at(now));
  };
  step("map", "odom", 0, 100, 0);
  step("odom", "base_link", 0, 0, 0);
  step("odom", "base_link", 0.05, 1, 0.05);
  ASSERT_EQ(graph.poses_x, std::vector<double>{100});
  step("map", "odom", 0.1, 102, 0.1);
  EXPECT_EQ(graph.poses_x, (std::vector<double>{100, 102})) << "101 half way, and 1";
  step("odom", "base_link", 0.2, 2, 0.2);
  graph.intake.tend(at(0.31));
  ASSERT_EQ(graph.poses_x.size(), 3U) << "the other step is late: its last pose is taken";
  EXPECT_EQ(graph.poses_x.back(), 104);
}

TEST(RosIntake, PosesOfATopicAreTakenWhereNoTransformMovesTheVehicle) {
  Graph graph("[topic./points]\npose = 0, 0, 1.7, 0, 0, 0\n");
  ros::Odometry odometry;
  odometry.header = {at(0), "odom"};
  odometry.child_frame_id = "base_link";
  odometry.pose.position[0] = 7;
  graph.cloud(0, 0);
  graph.intake.take("/odom", "nav_msgs/Odometry", ros::encoded(odometry, ros::Encoding::kCdr),
                    at(0.01));
  EXPECT_TRUE(graph.poses_x.empty()) << "transforms may still come";
  graph.intake.tend(at(2.1));
  EXPECT_EQ(graph.poses_x, std::vector<double>{7});
}

TEST(RosIntake, WhatCannotBeReadIsCountedAndNamed) {
  Graph graph;
  graph.mount(0);
  const std::string whole = cloudAt(0, "velodyne");
  std::uint64_t bad = 0;
  for (std::size_t size = 0; size < whole.size(); size += 3, ++bad)
    graph.intake.take("/points", "sensor_msgs/PointCloud2", whole.substr(0, size), at(0));
  // A sequence that says it has four thousand million elements.
  std::string forged = whole;
  forged.replace(forged.size() - 21, 4, "\xff\xff\xff\xff", 4);
  graph.intake.take("/points", "sensor_msgs/PointCloud2", forged, at(0)), ++bad;
  graph.intake.take("/tf", "tf2_msgs/TFMessage", std::string("\0\1\0\0\xff\xff\xff\x7f", 8), at(0)),
      ++bad;
  EXPECT_EQ(graph.intake.unreadable(), bad);
  EXPECT_EQ(graph.came, "");
  graph.cloud(0.1, 0.1);
  EXPECT_EQ(graph.came, "fs") << "what is whole is taken";
  EXPECT_NE(graph.intake.warnings().at(0).find("unreadable messages left out, the first: byte"),
            std::string::npos);
}

TEST(RosIntake, LateMessagesAndClocksThatDifferAreTold) {
  Graph graph;
  graph.mount(0);
  for (int i = 0; i < 20; ++i) graph.cloud(0.1 * i, 0.1 * i + 0.05);
  graph.cloud(1.0, 2.0);
  ros::Imu imu;
  for (int i = 0; i < 20; ++i) {
    imu.header = {at(0.1 * i + 30), "velodyne"};
    graph.intake.take("/imu", "sensor_msgs/Imu", ros::encoded(imu, ros::Encoding::kCdr),
                      at(0.1 * i + 0.01));
  }
  EXPECT_EQ(graph.intake.late(), 1U);
  std::string all;
  for (const std::string& warning : graph.intake.warnings()) all += warning + "\n";
  EXPECT_NE(all.find("/imu: its clock is 29.990 s ahead of this computer's"), std::string::npos)
      << all;
  EXPECT_NE(all.find("/points: 1 messages were stamped before the one before"), std::string::npos);
}

TEST(RosIntake, BoxesAreReadWhereTheIniNamesTheirTopic) {
  Graph none, named("[topic./boxes]\nlabel = BOXES\n");
  EXPECT_FALSE(none.intake.wants("/boxes", "vision_msgs/Detection3DArray"));
  EXPECT_TRUE(named.intake.wants("/boxes", "vision_msgs/Detection3DArray"));
  EXPECT_TRUE(none.intake.wants("/points", "sensor_msgs/PointCloud2"));
  EXPECT_FALSE(none.intake.wants("/odd", "sensor_msgs/Joy"));
}

TEST(RosIntake, AnIniWithAnUnknownKeyIsRefused) {
  EXPECT_THROW(Graph("[ros]\nnetwerk = lo\n"), ConfigError);
  EXPECT_THROW(Graph("[bag]\nposes = odom\n"), ConfigError);
}

}  // namespace
}  // namespace perception
