#include "libperception/simulation/cameras/CameraBoxes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kStanding, test::parked, test::scenarioOf;

const Pose3 kLens = makePose(0, 0, 1.65, 0) * opticalAxes();

/// A detector without faults of its own.
CameraParams perfect() {
  CameraParams p;
  p.recall = 1, p.edge_noise = 0, p.confusion = 0, p.false_per_image = 0;
  p.heading = true, p.heading_noise = 0, p.heading_flip = 0;
  return p;
}

TEST(CameraBoxes, OutlineIsTheProjection) {
  // A block 2 m wide and 1.5 m high whose front stands 9 m ahead.
  const World world(scenarioOf(kStanding + kCamera +
                               parked("b", "box", 10, 0, "length = 2\nwidth = 2\nheight = 1.5")));
  const CameraModel m = CameraParams().model();
  EXPECT_NEAR(m.fx, 727, 1);  // KITTI's 721 px
  const auto outline = imageOutline(world, 0, 0, m, kLens);
  ASSERT_TRUE(outline);
  EXPECT_NEAR(outline->box.x1, m.cx - m.fx / 9, 1e-3);
  EXPECT_NEAR(outline->box.x2, m.cx + m.fx / 9, 1e-3);
  EXPECT_NEAR(outline->box.y2, m.cy + m.fy * 1.65 / 9, 1e-3);
  EXPECT_NEAR(outline->box.y1, m.cy + m.fy * 0.15 / 11, 1e-3);
  EXPECT_EQ(outline->truncated, 0);
}

TEST(CameraBoxes, WhatLiesBehindOrBesideHasNoOutline) {
  const World world(scenarioOf(kStanding + kCamera + parked("a", "car", -10, 0) +
                               parked("b", "car", 3, 20) + parked("c", "car", 10, -8)));
  const CameraModel m = CameraParams().model();
  EXPECT_FALSE(imageOutline(world, 0, 0, m, kLens));
  EXPECT_FALSE(imageOutline(world, 1, 0, m, kLens));
  const auto cut = imageOutline(world, 2, 0, m, kLens);
  ASSERT_TRUE(cut);
  EXPECT_GT(cut->truncated, 0.1);
  EXPECT_EQ(cut->box.x2, m.width - 1);
}

TEST(CameraBoxes, PerfectDetectorFindsWhatIsVisibleWithItsHeading) {
  const World world(
      scenarioOf(kStanding + kCamera + parked("car", "car", 15, 3, "heading_deg = 30") +
                 parked("man", "pedestrian", 12, -3) + parked("rider", "cyclist", 16, -5) +
                 parked("wall", "box", 20, 0, "length = 1\nwidth = 5\nheight = 3") +
                 parked("hidden", "car", 26, 0)));
  const LidarCaster caster(world);
  const ObjectDetections d = detectBoxes(caster, 0, perfect(), kLens, {1, 0, 0, 1});
  ASSERT_EQ(d.objects.size(), 3u);
  EXPECT_EQ(d.objects[0].label, "Car");
  EXPECT_EQ(d.objects[1].label, "Pedestrian");
  EXPECT_EQ(d.objects[2].label, "Cyclist");
  ASSERT_TRUE(d.objects[0].heading);
  // KITTI: alpha = rotation_y - atan2(x, z) with rotation_y = -yaw - 90 deg, x = -3, z = 15.
  EXPECT_NEAR(*d.objects[0].heading, wrapAngle(-radians(30) - kPi / 2 - std::atan2(-3, 15)), 1e-6);
  EXPECT_FALSE(d.objects[1].heading);
}

TEST(CameraBoxes, RecallAndFalseBoxesHaveTheirRates) {
  const World world(scenarioOf(kStanding + kCamera + parked("car", "car", 15, 0)));
  const LidarCaster caster(world);
  CameraParams params = perfect();
  params.recall = 0.8;
  params.false_per_image = 0.5;
  constexpr int kImages = 600;
  int found = 0, wrong = 0;
  for (std::uint64_t i = 0; i < kImages; ++i) {
    const auto d = detectBoxes(caster, 0, params, kLens, {1, i, 0, 1});
    for (const auto& object : d.objects) (object.heading ? found : wrong) += 1;
  }
  EXPECT_NEAR(found, 0.8 * kImages, 4 * std::sqrt(0.8 * 0.2 * kImages));
  EXPECT_NEAR(wrong, 0.5 * kImages, 4 * std::sqrt(0.5 * kImages));
}

}  // namespace
}  // namespace perception
