#include <gtest/gtest.h>

#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/lidar/ground/GroundSurface.h"
#include "libperception/lidar/ground/SplitGround.h"
#include "tests/support/SyntheticCloud.h"

namespace perception {
namespace {

using test::castScan;
using test::SolidScene;
using test::SpinningLidar;

SpinningLidar coarse() {
  SpinningLidar lidar;
  lidar.azimuth_step = radians(1);
  return lidar;
}

SolidScene street() {
  SolidScene scene;
  scene.boxes = {{{12, 4}, 0.2, 4.4, 1.8, 0.2, 1.5},
                 {{-15, -6}, 0, 20, 1, 0, 4},
                 {{20, -8}, 1.0, 4.4, 1.8, 0.2, 1.5}};
  scene.cylinders = {{{8, -2}, 0.25, 0, 1.7}};
  return scene;
}

TEST(GroundEstimator, FindsATiltedPlaneAmongObstacles) {
  SolidScene scene = street();
  scene.ground = {0.03, -0.02, 0.1, 0.01, true};
  GroundEstimator estimator;
  const GroundPlane plane = estimator.update(castScan(scene, coarse(), Stamp::fromSeconds(1)));
  EXPECT_TRUE(plane.measured);
  EXPECT_NEAR(plane.a, 0.03, 0.002);
  EXPECT_NEAR(plane.b, -0.02, 0.002);
  EXPECT_NEAR(plane.c, 0.1, 0.03);
  EXPECT_LT(plane.sigma, 0.05);
}

TEST(GroundEstimator, FollowsWithItsTimeConstant) {
  GroundEstimator estimator;
  SolidScene scene = street();
  const double c0 = estimator.update(castScan(scene, coarse(), Stamp::fromSeconds(0))).c;
  scene.ground.c = 0.1;  // within wet_depth
  const double c1 = estimator.update(castScan(scene, coarse(), Stamp::fromSeconds(0.1))).c;
  EXPECT_NEAR(c1 - c0, 0.1 * 0.1, 0.004);
}

TEST(GroundEstimator, KeepsTheLastPlaneWithoutGround) {
  GroundEstimator estimator;
  SensorFrame empty;
  empty.data = LidarCloud{};
  EXPECT_FALSE(estimator.update(empty).measured);
  EXPECT_EQ(estimator.update(empty).c, 0);
  const GroundPlane seen = estimator.update(castScan(street(), coarse()));
  ASSERT_TRUE(seen.measured);
  const GroundPlane kept = estimator.update(empty);
  EXPECT_TRUE(kept.measured);
  EXPECT_EQ(kept.c, seen.c);
}

TEST(GroundEstimator, RefusesSteepPlanes) {
  SolidScene scene;
  scene.ground.a = std::tan(radians(8));
  GroundEstimator estimator;
  EXPECT_FALSE(estimator.update(castScan(scene, coarse())).measured);
}

/// Adds a mirror image of a wall below a wet road: `share` of the cloud's size.
void addMirrored(SensorFrame& frame, double share) {
  auto& cloud = std::get<LidarCloud>(frame.data);
  Rng rng(RngKey{2, 0, 0, 13});
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud.size()));
  for (std::size_t i = 0; i < count; ++i) {
    cloud.x.push_back(static_cast<float>(rng.uniform(8, 15)));
    cloud.y.push_back(static_cast<float>(rng.uniform(-5, 5)));
    cloud.z.push_back(static_cast<float>(-1.73 + rng.uniform(-2, -0.5)));
  }
}

TEST(GroundEstimator, FreezesForAWetRoadAndThawsAfter) {
  GroundEstimator estimator;
  const GroundPlane dry = estimator.update(castScan(street(), coarse(), Stamp::fromSeconds(0)));
  EXPECT_FALSE(estimator.wet());
  SensorFrame wet = castScan(street(), coarse(), Stamp::fromSeconds(0.1));
  addMirrored(wet, 0.2);
  EXPECT_EQ(estimator.update(wet).c, dry.c);
  EXPECT_TRUE(estimator.wet());
  EXPECT_GT(estimator.mirroredShare(), 0.05);
  estimator.update(castScan(street(), coarse(), Stamp::fromSeconds(1.9)));
  EXPECT_TRUE(estimator.wet());
  estimator.update(castScan(street(), coarse(), Stamp::fromSeconds(2.2)));
  EXPECT_FALSE(estimator.wet());
}

TEST(GroundEstimator, AClockThatGoesBackThaws) {
  GroundEstimator estimator;
  estimator.update(castScan(street(), coarse(), Stamp::fromSeconds(1000)));
  SensorFrame wet = castScan(street(), coarse(), Stamp::fromSeconds(1000.1));
  addMirrored(wet, 0.2);
  estimator.update(wet);
  ASSERT_TRUE(estimator.wet());
  estimator.update(castScan(street(), coarse(), Stamp::fromSeconds(10)));
  EXPECT_FALSE(estimator.wet());
}

TEST(GroundEstimator, MirroredReturnsDoNotPullThePlaneDown) {
  GroundEstimator estimator;
  estimator.update(castScan(street(), coarse(), Stamp::fromSeconds(0)));
  GroundPlane plane;
  for (int k = 1; k < 40; ++k) {
    SensorFrame frame = castScan(street(), coarse(), Stamp::fromSeconds(0.1 * k));
    addMirrored(frame, k % 2 == 0 ? 0.2 : 0.03);
    plane = estimator.update(frame);
  }
  EXPECT_NEAR(plane.c, 0, 0.05);  // method.md 8.1: below 5 cm
  EXPECT_NEAR(plane.a, 0, 0.002);
}

TEST(GroundEstimator, IsAFunctionOfScanAndSeed) {
  const SensorFrame frame = castScan(street(), coarse(), Stamp::fromSeconds(5));
  const GroundPlane one = GroundEstimator({}, 7).update(frame),
                    two = GroundEstimator({}, 7).update(frame);
  EXPECT_EQ(one.a, two.a);
  EXPECT_EQ(one.c, two.c);
}

TEST(GroundSurface, FollowsARampThatThePlaneMisses) {
  // Level to 15 m, then rising by 6 % (three boxes are no ramp: points made by hand).
  SensorFrame frame = castScan({}, coarse());
  auto& cloud = std::get<LidarCloud>(frame.data);
  std::size_t far = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float range = std::hypot(cloud.x[i], cloud.y[i]);
    if (range > 15) cloud.z[i] += 0.06f * (range - 15), ++far;
  }
  ASSERT_GT(far, 500u);
  const EgoPoints points = usablePoints(frame, {});
  const auto obstacles = [&](const SurfaceParams& params) {
    std::vector<float> heights;
    GroundSurface(frame.ground, points, params, &heights);
    int count = 0;
    for (std::size_t i = 0; i < heights.size(); ++i)
      count += heights[i] > 0.3f && std::hypot(points.x[i], points.y[i]) < 35;
    return count;
  };
  SurfaceParams plane_alone;
  plane_alone.local = false;
  EXPECT_GT(obstacles(plane_alone), 1000);  // within 35 m: beyond it leaves the bound
  EXPECT_LT(obstacles({}), obstacles(plane_alone) / 20);
}

/// The scan of a level road that is bent upward (downward) by `height` [m] of a range.
template <class Height>
SensorFrame bentRoad(const Height& height) {
  SensorFrame frame = castScan({}, coarse());
  auto& cloud = std::get<LidarCloud>(frame.data);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.z[i] += height(std::hypot(cloud.x[i], cloud.y[i]));
  return frame;
}

TEST(GroundSurface, FollowsASlopeWithinACell) {
  const auto curve = [](float range) {  // 50 m of radius, then 15 %
    const float into = std::max(range - 10, 0.0f);
    return into < 7.5f ? into * into / 100 : 0.15f * into - 0.5625f;
  };
  for (const float sign : {1.0f, -1.0f}) {
    const SensorFrame frame = bentRoad([&](float range) { return sign * curve(range); });
    const EgoPoints points = usablePoints(frame, {});
    std::vector<float> heights;
    GroundSurface(frame.ground, points, {}, &heights);
    for (std::size_t i = 0; i < heights.size(); ++i)
      if (std::hypot(points.x[i], points.y[i]) < 45) {
        EXPECT_NEAR(heights[i], 0, 0.15);
      }
  }
}

TEST(GroundSurface, TheTopOfAWallIsNoGround) {
  SolidScene scene;
  scene.boxes = {{{30, 0}, 0, 8, 30, 0, 0.6}};  // low enough to be seen from above
  const SensorFrame frame = castScan(scene, coarse());
  const EgoPoints points = usablePoints(frame, {});
  const GroundSurface surface(frame.ground, points, {});
  EXPECT_NEAR(surface.heightAt(27, 0), 0, 0.2);  // its foot, in cells without the road
  EXPECT_NEAR(surface.heightAt(30, 0), 0, 0.2);
}

TEST(GroundSurface, DoesNotSwallowACar) {
  SolidScene scene;
  scene.boxes = {{{18, 3}, 0.4, 4.4, 1.8, 0.35, 1.5}};  // its underside stands clear of the ground
  const SensorFrame frame = castScan(scene, SpinningLidar());
  const EgoPoints points = usablePoints(frame, {});
  const GroundSurface surface(frame.ground, points, {});
  EXPECT_NEAR(surface.heightAt(16, 2.5), 0, 0.1);
  EXPECT_NEAR(surface.heightAt(18, 3), 0, 0.1);
  EXPECT_NEAR(surface.heightAt(24, 4), 0, 0.1);  // in its shadow
}

TEST(SlabParts, AreThoseOfTheRules) {
  const SlabRules rules{-0.3F, 0.3F, 0.25F, 2.5F, -1, -0.5F};
  const std::vector<float> x = {-5, -5, -5, -5, -5, -5, 5, 1, -5}, y = {0, 0, 0, 0, 0, 0, 1, 3, 0},
                           heights = {-0.3F, 0, 0.25F, 0.28F, 0.3F, 2.5F, 1, 1, -1};
  SlabParts parts;
  parts.find(x.data(), y.data(), heights.data(), x.size(), rules);
  const auto of = [](const SlabParts::Part& part) {
    return std::vector<std::uint32_t>(part.index.begin(),
                                      part.index.begin() + static_cast<std::ptrdiff_t>(part.count));
  };
  EXPECT_EQ(of(parts.obstacles), std::vector<std::uint32_t>({3, 4, 7}));
  EXPECT_EQ(of(parts.others), std::vector<std::uint32_t>({1, 2, 5}));
  EXPECT_EQ(of(parts.road), std::vector<std::uint32_t>({1, 2, 3}));
}

TEST(UsablePoints, DropsBadOwnAndRainyReturns) {
  SensorFrame frame;
  LidarCloud cloud;
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              inf = std::numeric_limits<float>::infinity();
  cloud.x = {10, nan, 10, 1e30f, inf, 1, 10, 10, 200};
  cloud.y = {0, 0, nan, 0, 0, 0.5f, 1, 2, 0};
  cloud.z = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  cloud.label.assign(9, static_cast<std::uint8_t>(PointLabel::kObject));
  cloud.label[6] = static_cast<std::uint8_t>(PointLabel::kRain);
  cloud.label[7] = static_cast<std::uint8_t>(PointLabel::kDirt);
  frame.data = cloud;
  const EgoPoints points = usablePoints(frame, {});
  EXPECT_EQ(points.source, std::vector<std::uint32_t>{0});
  EXPECT_EQ(points.dropped, 4u);
}

TEST(RoughBearing, IsGoodForSectors) {
  for (int k = 0; k < 3600; ++k) {
    const double angle = radians(k * 0.1 - 180);
    const float x = static_cast<float>(7 * std::cos(angle)),
                y = static_cast<float>(7 * std::sin(angle));
    EXPECT_NEAR(wrapAngle(static_cast<double>(fastAtan2(x, y)) - angle), 0, 3e-4);
  }
}

TEST(CloseBearing, IsGoodForMeasuring) {
  for (int k = 0; k < 360000; ++k) {
    const double angle = radians(k * 0.001 - 180);
    const float x = static_cast<float>(7 * std::cos(angle)),
                y = static_cast<float>(7 * std::sin(angle));
    const double exact = std::atan2(static_cast<double>(y), static_cast<double>(x));
    ASSERT_NEAR(wrapAngle(static_cast<double>(closeAtan2(x, y)) - exact), 0, 1e-6) << angle;
  }
}

}  // namespace
}  // namespace perception
