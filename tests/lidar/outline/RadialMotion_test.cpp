#include "libperception/lidar/outline/RadialMotion.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::SolidScene;

constexpr double kScanTime = 0.1;
const Stamp kMovedAt = Stamp::fromSeconds(1000);

/// A box 1.8 m wide whose middle is there in the ego frame.
SolidScene boxAt(double x, double y, double yaw) {
  SolidScene scene;
  scene.boxes = {{{x, y}, yaw, 4.5, 1.8, 0.3, 1.5}};
  return scene;
}

/// Two scans of a vehicle that drives along its x axis.
struct TwoScans {
  double own = 14;  ///< [m/s]
  double world_yaw = 0;
  SolidScene before = boxAt(17, 0, 0), now = boxAt(17, 0, 0);  ///< as seen from the vehicle
  double time = kScanTime;
  int drops = 0;  ///< returns of a cloud up to 2.5 m before 14.7 m in each scan

  EgoState egoAt(double t) const {
    EgoState ego;
    ego.stamp = kMovedAt + t;
    ego.velocity = own * Vector2(std::cos(world_yaw), std::sin(world_yaw));
    ego.T_world_ego = makePose(0, 0, 0, world_yaw) * makePose(own * t, 0, 0, 0);
    return ego;
  }
  SensorFrame frameOf(const SolidScene& scene, std::uint64_t seed) const {
    SensorFrame frame = test::castScan(scene, test::narrowLidar(), kMovedAt, seed);
    auto& cloud = std::get<LidarCloud>(frame.data);
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<float> x(12.2F, 14.6F), y(-1.2F, 1.2F), z(-1.3F, -0.3F);
    for (int k = 0; k < drops; ++k) {
      cloud.x.push_back(x(rng)), cloud.y.push_back(y(rng)), cloud.z.push_back(z(rng));
      if (!cloud.intensity.empty()) cloud.intensity.push_back(0.1F);
      if (!cloud.ring.empty()) cloud.ring.push_back(0);
    }
    return frame;
  }
  /// The cluster of all that lies within 4 m of the box.
  std::optional<MovingCluster> moved(std::vector<Vector2>* behind_cloud = nullptr) const {
    const LidarFrontEnd lidar = test::plainFrontEnd();
    EarlierScan earlier;
    earlier.stamp = kMovedAt + -time;
    earlier.T_world_ego = egoAt(-time).T_world_ego;
    earlier.returns = lidar.extract(frameOf(before, 1)).returns;
    const LidarDetections found = lidar.detect(frameOf(now, 2));
    const Vector2 center = now.boxes[0].center;
    const auto points = test::obstaclesWhere(
        found, [&](double x, double y) { return (Vector2(x, y) - center).norm() < 5; });
    const EgoState ego = egoAt(0);
    auto moving = RadialMotion(earlier, found, ego, kMovedAt).of(points);
    if (behind_cloud != nullptr && moving) {
      for (const std::uint32_t k : moving->behind_cloud)
        behind_cloud->emplace_back(static_cast<double>(found.x[k]),
                                   static_cast<double>(found.y[k]));
    }
    return moving;
  }
};

TEST(RadialMotion, AVehicleAheadThatKeepsItsDistanceIsAsFastAsTheOwnOne) {
  const auto moving = TwoScans().moved();
  ASSERT_TRUE(moving);
  EXPECT_NEAR(moving->speed.along.mean, 14, 0.5);
  EXPECT_LT((moving->speed.direction - Vector2::UnitX()).norm(), 0.02);
  EXPECT_NEAR(std::sqrt(moving->speed.along.variance), 1, 0.1) << "0.1 m in 0.1 s";
  EXPECT_TRUE(moving->behind_cloud.empty());
}

TEST(RadialMotion, WhatStandsHasNone) {
  TwoScans scans;
  scans.before = boxAt(18.4, 0, 0);
  EXPECT_FALSE(scans.moved());
}

TEST(RadialMotion, OneThatComesHasANegativeSpeedWhichTimesTellLessExactly) {
  TwoScans scans;
  scans.before = boxAt(20.4, 0, 0);  // 34 m/s nearer
  const auto moving = scans.moved();
  ASSERT_TRUE(moving);
  EXPECT_NEAR(moving->speed.along.mean, -20, 0.5);
  EXPECT_NEAR(std::sqrt(moving->speed.along.variance), std::hypot(1, 3.4), 0.1);
}

TEST(RadialMotion, TurnsWithTheWorld) {
  TwoScans scans;
  scans.world_yaw = 2;
  const auto moving = scans.moved();
  ASSERT_TRUE(moving);
  EXPECT_NEAR(moving->speed.along.mean, 14, 0.5);
  EXPECT_LT((moving->speed.direction - Vector2(std::cos(2), std::sin(2))).norm(), 0.02);
}

// The rear is a plane: how fast it moves along itself is not seen.
TEST(RadialMotion, OfAnObliqueSurfaceItIsTheSpeedAlongItsNormal) {
  TwoScans scans;
  const double yaw = 0.3;
  scans.now = boxAt(17, 0, yaw);
  scans.before = boxAt(17 + 1.4 - 1.4 * std::cos(yaw), -1.4 * std::sin(yaw), yaw);
  const auto moving = scans.moved();
  ASSERT_TRUE(moving);
  EXPECT_NEAR(moving->speed.along.mean, 14, 1);
  EXPECT_LT((moving->speed.direction - Vector2(std::cos(yaw), std::sin(yaw))).norm(), 0.12);
}

TEST(RadialMotion, ASideSeenAtAGrazingAngleTellsNothing) {
  TwoScans scans;
  scans.before = scans.now = boxAt(12, 4.5, 0);  // 20 deg to the left, its side across
  scans.now.boxes[0].length = scans.before.boxes[0].length = 12;
  EXPECT_FALSE(scans.moved());
}

TEST(RadialMotion, ACloudBeforeARearHidesNeitherItsSpeedNorItsPlace) {
  TwoScans scans;
  scans.drops = 150;
  std::vector<Vector2> kept;
  const auto moving = scans.moved(&kept);
  ASSERT_TRUE(moving);
  EXPECT_NEAR(moving->speed.along.mean, 14, 0.5);
  ASSERT_GT(kept.size(), 100u);
  for (const Vector2& p : kept) {
    EXPECT_GT(p.x(), 14.2) << "drops hang up to 12.2";
    EXPECT_LT(std::abs(p.y()), 1.05) << "the rear is 0.9 m to each side";
  }
}

TEST(RadialMotion, ScansFarApartInTimeTellNothing) {
  TwoScans scans;
  scans.time = 0.3;
  scans.before = boxAt(17, 0, 0);
  EXPECT_FALSE(scans.moved());
}

TEST(RadialMotion, TheFrontEndMeasuresItOfItsClustersWhereItKnowsTheScanBefore) {
  const LidarFrontEnd lidar = test::shapedFrontEnd(
      {ObjectShape::kVehicle}, std::make_shared<ClusterClassifier>(test::vehiclesAlone()));
  const TwoScans scans;
  SensorFrame frame = scans.frameOf(scans.now, 2);
  frame.ego = scans.egoAt(0);
  const MeasurementScan alone = lidar.extract(frame);
  ASSERT_EQ(alone.measurements.size(), 1u);
  EXPECT_FALSE(alone.measurements[0].radial_speed);
  frame.before = std::make_shared<const EarlierScan>(
      EarlierScan{kMovedAt + -kScanTime, scans.egoAt(-kScanTime).T_world_ego, alone.returns});
  const MeasurementScan scan = lidar.extract(frame);
  ASSERT_EQ(scan.measurements.size(), 1u);
  ASSERT_TRUE(scan.measurements[0].radial_speed);
  EXPECT_NEAR(scan.measurements[0].radial_speed->along.mean, 14, 0.5);
}

}  // namespace
}  // namespace perception
