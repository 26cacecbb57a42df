#include "libperception/simulation/Simulator.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

const std::string kDriveScene =
    kStanding + "pose_rate = 20\npose_sigma_xy = 0.1\n" + kRoofLidar +
    "azimuth_from_deg = -40\nazimuth_to_deg = 40\nazimuth_step_deg = 0.5\n" + kCamera +
    "rate = 6.5\n" + parked("car", "car", 12, 3) +
    "[object.man]\nkind = pedestrian\nt = 0, 1\nx = 10, 10\ny = -2, 0\n" +
    parked("wall", "box", 30, 0) + parked("pole", "pole", 9, 4);

std::vector<std::shared_ptr<mrpt::obs::CObservation>> playSimulator(Simulator& simulator) {
  std::vector<std::shared_ptr<mrpt::obs::CObservation>> log;
  while (auto observation = simulator.next()) log.push_back(observation);
  return log;
}

TEST(Simulator, LogStartsWithACommentThatCallsItSimulated) {
  Simulator simulator(scenarioOf(kDriveScene), "street", 7);
  const auto first = std::dynamic_pointer_cast<mrpt::obs::CObservationComment>(simulator.next());
  ASSERT_TRUE(first);
  EXPECT_EQ(first->text, "simulated log: scenario street, seed 7");
}

TEST(Simulator, ObservationsComeInOrderAtTheirRates) {
  Simulator simulator(scenarioOf(kDriveScene), "street", 7);
  std::map<std::string, int> counts;
  std::int64_t frame = -1;
  Stamp last;
  for (const auto& o : playSimulator(simulator)) {
    const auto stamp = toStamp(o->timestamp);
    ASSERT_TRUE(stamp);
    EXPECT_LE(last, *stamp);
    last = *stamp;
    ++counts[o->sensorLabel];
    if (const auto number = frameNumber(*o)) {
      EXPECT_EQ(*number, frame + 1);
      frame = *number;
    }
  }
  EXPECT_EQ(counts["EGO_POSE"], 21);
  EXPECT_EQ(counts["FRAME"], 11);
  EXPECT_EQ(counts["LIDAR_TOP"], 11);
  EXPECT_EQ(counts["CAMERA"], 7);
  EXPECT_EQ(simulator.frames(), 11);
}

TEST(Simulator, TruthVelocitiesAreDifferencesOfPositions) {
  Simulator simulator(scenarioOf(kStanding + kCamera +
                                 "[object.a]\nkind = car\nt = 0, 0.4, 1\nx = 10, 13, 20\n"
                                 "y = 0, 1, 9\n[scenario]\nrate = 100\n"),
                      "street", 7);
  playSimulator(simulator);
  const auto& truth = simulator.truth();
  ASSERT_EQ(truth.size(), 101u);
  for (std::size_t i = 1; i + 1 < truth.size(); ++i) {
    if (i == 40) continue;  // a waypoint: the acceleration jumps
    const Vector3 difference = (truth[i + 1].position - truth[i - 1].position) / 0.02;
    EXPECT_NEAR(truth[i].vx, difference.x(), 0.01);
    EXPECT_NEAR(truth[i].vy, difference.y(), 0.01);
    EXPECT_NEAR(truth[i].yaw, std::atan2(truth[i].vy, truth[i].vx), 1e-9);
  }
}

TEST(Simulator, TruthCountsTheReturnsInTheBox) {
  Simulator simulator(scenarioOf(kDriveScene), "street", 7);
  const auto log = playSimulator(simulator);
  std::vector<int> inside;
  for (const auto& o : log) {
    const auto frame = frameFromObservation(*o);
    if (!frame || frame->sensor != "LIDAR_TOP") continue;
    const auto& cloud = std::get<LidarCloud>(frame->data);
    int count = 0;  // the car: 12 m ahead, 3 m to the left, 4.5 by 1.8 by 1.5 m; margins for noise
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      count += std::abs(cloud.x[i] - 12) < 2.3 && std::abs(cloud.y[i] - 3) < 0.95 &&
               cloud.z[i] > -1.68f && cloud.z[i] < 0;
    }
    inside.push_back(count);
  }
  ASSERT_EQ(inside.size(), 11u);
  for (const TruthObject& row : simulator.truth()) {
    EXPECT_NE(row.id, 3) << "walls are no objects";
    EXPECT_EQ(row.ignore, row.type == "Misc");
    if (row.id != 1) continue;
    const double counted = inside[static_cast<std::size_t>(row.frame)];
    EXPECT_GT(row.lidar_points, 150);
    EXPECT_NEAR(row.lidar_points, counted, 0.03 * counted);
    EXPECT_EQ(row.occluded, 0);
  }
}

TEST(Simulator, HiddenThingsAreOfUnknownOcclusionAndWithoutReturns) {
  Simulator simulator(scenarioOf(kStanding + kRoofLidar + parked("car", "car", 20, 0) +
                                 parked("bus", "bus", 9, 0, "heading_deg = 90")),
                      "street", 7);
  playSimulator(simulator);
  ASSERT_EQ(simulator.truth().size(), 22u);
  EXPECT_EQ(simulator.truth()[0].occluded, 3);
  EXPECT_EQ(simulator.truth()[0].lidar_points, 0);
  EXPECT_EQ(simulator.truth()[1].occluded, 0);
  EXPECT_GT(simulator.truth()[1].lidar_points, 2000);
}

TEST(Simulator, WithoutLidarTheTruthCountsNoReturns) {
  Simulator simulator(scenarioOf(kStanding + kCamera + parked("car", "car", 20, 0)), "street", 7);
  playSimulator(simulator);
  EXPECT_EQ(simulator.truth().front().lidar_points, -1);
}

TEST(Simulator, ReportedPoseHasItsErrorAndSaysSo) {
  Simulator simulator(scenarioOf(kDriveScene), "street", 7);
  int poses = 0;
  for (const auto& o : playSimulator(simulator)) {
    const auto pose = std::dynamic_pointer_cast<mrpt::obs::CObservationRobotPose>(o);
    if (!pose) continue;
    EXPECT_NE(pose->pose.mean.x(), 0);
    EXPECT_LT(std::abs(pose->pose.mean.x()), 0.5);  // 5 sigma
    EXPECT_NEAR(pose->pose.cov(0, 0), 0.01, 1e-12);
    ++poses;
  }
  EXPECT_EQ(poses, 21);
}

std::string bytesOf(std::uint64_t seed, int threads) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("perception_simulator_" + std::to_string(seed) + "_" +
                     std::to_string(threads) + "_" + std::to_string(::getpid()) + ".rawlog");
  Simulator simulator(scenarioOf(kDriveScene), "street", seed, threads);
  {
    RawlogWriter writer(path.string());
    while (const auto o = simulator.next()) writer.write(*o);
    writer.close();
  }
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  std::filesystem::remove(path);
  return bytes.str();
}

TEST(Simulator, SameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  const std::string one = bytesOf(7, 1);
  EXPECT_GT(one.size(), 100000u);
  EXPECT_TRUE(one == bytesOf(7, 1));
  EXPECT_TRUE(one == bytesOf(7, 3));
  EXPECT_FALSE(one == bytesOf(8, 1));
}

}  // namespace
}  // namespace perception
