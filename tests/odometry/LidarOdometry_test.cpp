#include "libperception/odometry/LidarOdometry.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <filesystem>

#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

struct Drift {
  double way = 0, position = 0, yaw = 0;  ///< [m, m, rad] driven; at the end
  std::size_t scans = 0;
  std::uint64_t lost = 0;
};

/// Odometry beside the log's poses; both begin at the first scan.
Drift driftOn(const std::string& log) {
  registerPerceptionClasses();
  EgoPoseParams params;
  params.history = 1e6;
  EgoPose poses(params);
  std::vector<SensorFrame> frames;
  std::vector<EgoState> truth;
  {
    RawlogReader reader(log);
    while (const auto observation = reader.next())
      if (dynamic_cast<const mrpt::obs::CObservationRobotPose*>(observation.get()) != nullptr)
        poses.add(*observation);
      else if (observation->sensorLabel == "LIDAR_TOP")
        frames.push_back(*frameFromObservation(*observation));
  }
  LidarOdometry odometry;
  Drift drift;
  std::optional<Pose3> T_first, T_last;
  for (const auto& frame : frames) {
    const auto pose = odometry.update(frame);
    const auto true_state = poses.at(frame.stamp);
    if (!pose || !true_state) continue;
    if (!T_first) T_first = true_state->T_world_ego;
    const Pose3 T = T_first->inverse() * true_state->T_world_ego;
    if (T_last) drift.way += (T.translation() - T_last->translation()).norm();
    T_last = T;
    const Pose3 error = T.inverse() * *pose;
    drift.position = error.translation().norm();
    drift.yaw = std::abs(yawOf(error));
    ++drift.scans;
  }
  drift.lost = odometry.lost();
  return drift;
}

/// A street: ground, two walls with gables, poles; returns within 40 m, in the vehicle frame.
SensorFrame streetAt(const Pose3& T_world_ego, double t) {
  LidarCloud cloud;
  const Pose3 T_ego_world = T_world_ego.inverse();
  const auto add = [&](double x, double y, double z) {
    const Vector3 p = T_ego_world * Vector3(x, y, z);
    if (p.norm() > 40) return;
    cloud.x.push_back(static_cast<float>(p.x()));
    cloud.y.push_back(static_cast<float>(p.y()));
    cloud.z.push_back(static_cast<float>(p.z()));
  };
  for (double x = -50; x < 90; x += 0.2) {
    for (double y = -8; y < 8; y += 0.2) add(x, y, 0);
    for (double z = 0; z < 4; z += 0.2) {
      add(x, 8, z), add(x, -8, z);
      const bool gable = std::fmod(x + 50, 10) < 0.1;
      for (double y = 6; gable && y < 8; y += 0.2) add(x, y, z), add(x, -y, z);
    }
  }
  SensorFrame frame;
  frame.sensor = "LIDAR";
  frame.stamp = Stamp{1000000000000 + static_cast<std::int64_t>(t * 1e9)};
  frame.data = cloud;
  return frame;
}

TEST(LidarOdometry, FollowsADriveThroughASimulatedStreet) {
  LidarOdometry odometry;
  Pose3 truth = Pose3::Identity(), found = truth;
  for (int i = 0; i < 20; ++i) {
    const auto pose = odometry.update(streetAt(truth, 0.1 * i));
    ASSERT_TRUE(pose);
    found = *pose;
    const Pose3 error = truth.inverse() * found;
    EXPECT_LT(error.translation().norm(), 0.1) << i;
    EXPECT_LT(std::abs(yawOf(error)), radians(0.5)) << i;
    truth = truth * makePose(1.2, 0, 0, radians(i < 10 ? 0.5 : -0.5));
  }
  EXPECT_EQ(odometry.lost(), 0U);
  EXPECT_GT(found.translation().x(), 20);
}

TEST(LidarOdometry, ScanOfAnotherPlaceIsReportedAsLost) {
  LidarOdometry odometry;
  for (int i = 0; i < 5; ++i) odometry.update(streetAt(makePose(0.5 * i, 0, 0, 0), 0.1 * i));
  EXPECT_EQ(odometry.lost(), 0U);
  SensorFrame empty = streetAt(Pose3::Identity(), 0.5);
  empty.data = LidarCloud{};
  const auto pose = odometry.update(empty);
  ASSERT_TRUE(pose);
  EXPECT_EQ(odometry.lost(), 1U);
  EXPECT_NEAR(pose->translation().x(), 2.5, 0.1);  // the motion before
}

TEST(LidarOdometry, IgnoresFramesOutOfOrder) {
  LidarOdometry odometry;
  EXPECT_TRUE(odometry.update(streetAt(Pose3::Identity(), 1)));
  EXPECT_FALSE(odometry.update(streetAt(Pose3::Identity(), 1)));
  EXPECT_FALSE(odometry.update(streetAt(Pose3::Identity(), 0)));
}

TEST(LidarOdometry, DriftsByLittleBesideTheLogsPoses) {
  // Simulated. Few things stand there: the first motion is badly observable, turns are not.
  const Drift drift = driftOn(PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog");
  EXPECT_EQ(drift.scans, 111U);
  EXPECT_EQ(drift.lost, 0U);
  EXPECT_LT(drift.position, 0.05 * drift.way);
  EXPECT_LT(drift.yaw, radians(1));
}

}  // namespace
}  // namespace perception
