#include "libperception/lidar/description/ClusterDescriptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::ObstacleScan;
using test::SolidBox;
using test::SolidCylinder;
using test::SolidScene;

double value(const Descriptor& d, Feature f) {
  return static_cast<double>(d[static_cast<std::size_t>(f)]);
}

/// A van of which one side is seen: from 0.25 to 2 m, its roof above the sensor.
SolidBox van(double x, double y) { return {{x, y}, kPi / 2, 4.4, 1.8, 0.25, 2}; }

TEST(ClusterDescriptor, EveryFeatureHasANameOfItsOwn) {
  const std::set<std::string> names(featureNames().begin(), featureNames().end());
  EXPECT_EQ(names.size(), kFeatures);
  EXPECT_STREQ(featureNames()[static_cast<std::size_t>(Feature::kLogReturns)], "log_returns");
  EXPECT_STREQ(featureNames()[static_cast<std::size_t>(Feature::kThrough)], "through");
  EXPECT_STREQ(featureNames()[static_cast<std::size_t>(Feature::kTouching)], "touching");
}

TEST(ClusterDescriptor, ASideOfAVanIsAPlaneAcrossTheLineOfSight) {
  SolidScene scene;
  scene.boxes = {van(10.9, 0)};
  ObstacleScan scan(scene);
  const auto members = scan.within(9, 12, -3, 3);
  const Descriptor d = scan.describe(members);
  EXPECT_NEAR(value(d, Feature::kLength), 4.4, 0.15);
  EXPECT_LT(value(d, Feature::kWidth), 0.1);
  EXPECT_NEAR(value(d, Feature::kBottom), 0.34, 0.05) << "lower ones are removed as ground";
  EXPECT_NEAR(value(d, Feature::kTop), 1.95, 0.06);
  EXPECT_NEAR(value(d, Feature::kHeight), value(d, Feature::kTop) - value(d, Feature::kBottom),
              1e-5);
  EXPECT_NEAR(value(d, Feature::kArea), value(d, Feature::kLength) * value(d, Feature::kWidth),
              1e-5);
  EXPECT_NEAR(value(d, Feature::kRange), 10, 0.05);
  EXPECT_LT(value(d, Feature::kAspect), 0.05);
  EXPECT_NEAR(value(d, Feature::kSpread1), 4.4 / std::sqrt(12), 0.05);
  EXPECT_NEAR(value(d, Feature::kSpread2), value(d, Feature::kHeight) / std::sqrt(12), 0.05);
  EXPECT_LT(value(d, Feature::kSpread3), 0.01);
  EXPECT_GT(value(d, Feature::kPlanarity), 0.3);
  EXPECT_LT(value(d, Feature::kScatter), 0.01);
  EXPECT_LT(value(d, Feature::kNormalUp), 0.05);
  EXPECT_LT(value(d, Feature::kDirectionUp), 0.05);
  EXPECT_LT(value(d, Feature::kRoughness), 0.01);
  EXPECT_GT(value(d, Feature::kEdgeShare), 0.95);
  EXPECT_NEAR(value(d, Feature::kFill), 1, 0.25);
  EXPECT_NEAR(value(d, Feature::kSeenArea), 4.4 * value(d, Feature::kHeight), 2);
  EXPECT_EQ(value(d, Feature::kHoles), 0);
  EXPECT_EQ(value(d, Feature::kThrough), 0);
  EXPECT_EQ(value(d, Feature::kCut), 0);
  EXPECT_NEAR(value(d, Feature::kLogReturns), std::log(static_cast<double>(members.size())), 1e-5);
  double shares = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    shares += static_cast<double>(d[static_cast<std::size_t>(Feature::kShare1) + k]);
    EXPECT_NEAR(static_cast<double>(d[static_cast<std::size_t>(Feature::kLength1) + k]), 4.4, 0.2);
  }
  EXPECT_NEAR(shares, 1, 1e-5);
}

TEST(ClusterDescriptor, AWallAlongTheLineOfSightHasAnAspectOfOne) {
  SolidScene scene;
  scene.boxes = {{{11, 1.5}, 0, 6, 0.2, 0, 2.5}};
  ObstacleScan scan(scene);
  const Descriptor d = scan.describe(7, 15, 1.2, 1.8);
  EXPECT_GT(value(d, Feature::kAspect), 0.97);
  EXPECT_NEAR(value(d, Feature::kLength), 6, 0.6) << "0.6 m between beams at its end";
}

TEST(ClusterDescriptor, APoleIsAnUprightLine) {
  SolidScene scene;
  scene.cylinders = {{{8, 0}, 0.1, 0, 2.8}};
  ObstacleScan scan(scene);
  const Descriptor d = scan.describe(7, 9, -1, 1);
  EXPECT_LT(value(d, Feature::kLength), 0.3);
  EXPECT_GT(value(d, Feature::kUprightness), 6);
  EXPECT_GT(value(d, Feature::kDirectionUp), 0.99);
  EXPECT_GT(value(d, Feature::kLinearity), 0.8);
  EXPECT_LT(value(d, Feature::kTopSpread), 0.3);
}

TEST(ClusterDescriptor, BehindAFenceIsSomethingOrNot) {
  SolidScene scene;
  scene.cylinders = {{{10, -0.5}, 0.15, 0, 2}, {{10, 0.5}, 0.15, 0, 2}};
  const auto shown = [&] { return ObstacleScan(scene).describe(9, 11, -1, 1); };
  const Descriptor open = shown();  // 18 cells, 9 of them between the posts
  EXPECT_NEAR(value(open, Feature::kHoles), 0.5, 0.12);
  EXPECT_LT(value(open, Feature::kFill), 0.75);
  scene.boxes = {{{15, 0}, kPi / 2, 8, 0.5, 0, 4}};
  const Descriptor closed = shown();
  EXPECT_EQ(value(closed, Feature::kHoles), value(open, Feature::kHoles));
  EXPECT_EQ(value(closed, Feature::kThrough), value(closed, Feature::kHoles));
  EXPECT_LT(value(open, Feature::kThrough), value(closed, Feature::kThrough) - 0.1)
      << "through to the ground alone, not to the sky";
}

TEST(ClusterDescriptor, WhatStandsBeforeAnEndCutsIt) {
  SolidScene scene;
  scene.boxes = {van(12.9, 0)};
  EXPECT_EQ(value(ObstacleScan(scene).describe(11, 14, -3, 3), Feature::kCut), 0);
  scene.cylinders = {{{7, -1.2}, 0.2, 0, 2.5}};
  EXPECT_NEAR(value(ObstacleScan(scene).describe(11, 14, -3, 3), Feature::kCut), 0.5, 0.06)
      << "of its two ends";
}

TEST(ClusterDescriptor, TheEdgeOfTheFieldCutsAnEnd) {
  SolidScene scene;
  scene.boxes = {van(12.9, 6.5)};  // to 8.7 m on the left, seen to 30 degrees: 6.9 m
  EXPECT_NEAR(value(ObstacleScan(scene).describe(11, 14, 3, 9), Feature::kCut), 0.5, 0.06);
  scene.boxes = {van(12.9, 4)};
  EXPECT_EQ(value(ObstacleScan(scene).describe(11, 14, 1, 9), Feature::kCut), 0);
}

TEST(ClusterDescriptor, IsolationIsTheDistanceToTheNextObstacle) {
  SolidScene scene;
  scene.boxes = {van(10.9, 0)};
  const Descriptor alone = ObstacleScan(scene).describe(9, 12, -3, 3);
  EXPECT_EQ(value(alone, Feature::kIsolation), 3);
  EXPECT_EQ(value(alone, Feature::kTouching), 0);
  for (const double gap : {0.2, 1.0, 2.0}) {
    scene.cylinders = {{{10, 2.2 + gap + 0.1}, 0.1, 0, 2}};
    const Descriptor beside = ObstacleScan(scene).describe(9, 12, -3, 2.25);
    // Few of the returns are looked at.
    EXPECT_GE(value(beside, Feature::kIsolation), gap - 0.01);
    EXPECT_LE(value(beside, Feature::kIsolation), gap + 0.25);
    EXPECT_EQ(value(beside, Feature::kTouching) > 0, gap < 0.5) << gap;
  }
}

TEST(ClusterDescriptor, MembersOfAnotherClusterOfTheScanAreNeighbors) {
  SolidScene scene;
  scene.cylinders = {{{10, -0.5}, 0.1, 0, 2}, {{10, 0.5}, 0.1, 0, 2}};
  ObstacleScan scan(scene);
  const DirectionCells cells(scan.found.points);
  ClusterDescriber describer(scan.found, scan.cloud(), cells);
  const auto isolation = [&](double y0, double y1) {
    return value(describer.describe(scan.within(9, 11, y0, y1)), Feature::kIsolation);
  };
  EXPECT_NEAR(isolation(-1, 0), 0.85, 0.1);
  EXPECT_NEAR(isolation(0, 1), 0.85, 0.1);
  EXPECT_EQ(isolation(-1, 1), 3);
}

/// A van and a brighter person beside it.
ObstacleScan brightPerson(float scale) {
  SolidScene scene;
  scene.boxes = {van(12.9, 1)};
  scene.cylinders = {{{10, -3}, 0.25, 0, 1.75}};
  ObstacleScan scan(scene);
  LidarCloud& cloud = scan.cloud();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float shade = 0.1f + 0.01f * static_cast<float>(i % 7);
    cloud.intensity.push_back(scale * (cloud.y[i] < -2 ? 0.5f + shade : shade));
  }
  return scan;
}

TEST(ClusterDescriptor, IntensitiesAreRanksWhateverTheirScale) {
  ObstacleScan unit = brightPerson(1), bytes = brightPerson(255);
  const auto person = unit.within(9, 11, -4, -2), rest = unit.within(9, 14, -2, 5);
  const Descriptor a = unit.describe(person), b = bytes.describe(person);
  const double share =
      static_cast<double>(person.size()) / static_cast<double>(person.size() + rest.size());
  EXPECT_NEAR(value(a, Feature::kIntensityMean), 1 - share / 2, 0.01) << "the brightest of all";
  EXPECT_NEAR(value(unit.describe(rest), Feature::kIntensityMean), (1 - share) / 2, 0.01);
  EXPECT_GT(value(a, Feature::kIntensitySpread), 0);
  for (const Feature f :
       {Feature::kIntensityMean, Feature::kIntensitySpread, Feature::kIntensityHigh})
    EXPECT_NEAR(value(a, f), value(b, f), 0.01);
}

TEST(ClusterDescriptor, WithoutIntensitiesTheyAreTheUsualOnes) {
  ObstacleScan scan = brightPerson(1);
  const auto person = scan.within(9, 11, -4, -2);
  const Descriptor shaded = scan.describe(person);
  scan.cloud().intensity.clear();
  const Descriptor d = scan.describe(person);
  EXPECT_NEAR(value(d, Feature::kIntensityMean), 0.4, 0.1);
  EXPECT_GT(value(d, Feature::kIntensitySpread), 0.1) << "none is what flakes have";
  EXPECT_GT(value(d, Feature::kIntensityHigh), 0.6);
  std::vector<float>& equal = scan.cloud().intensity;
  equal.assign(scan.cloud().size(), 0.3f);
  EXPECT_EQ(scan.describe(person), d);
  EXPECT_EQ(value(d, Feature::kLength), value(shaded, Feature::kLength));
}

TEST(ClusterDescriptor, DoesNotDependOnTheYawOfTheVehicle) {
  const auto shown = [](double turn) {
    SolidScene scene;
    for (const Vector2& place : {Vector2(12, 1), Vector2(9, -3.5)})
      scene.boxes.push_back({rotate2(turn, place), turn + 0.4, 4.4, 1.8, 0.25, 1.5});
    test::SpinningLidar lidar = test::narrowLidar();
    lidar.T_ego_sensor = makePose(0, 0, 1.73, turn);
    ObstacleScan scan(scene, lidar);
    return scan.describe(test::obstaclesWhere(scan.found, [turn](double x, double y) {
      const Vector2 p = rotate2(-turn, Vector2(x, y));
      return p.y() > -1.5;
    }));
  };
  const Descriptor ahead = shown(0);
  EXPECT_NEAR(value(ahead, Feature::kLength), 4.4, 0.3);
  for (const double turn : {0.3, kPi / 2, 3.1, -2.0}) {
    const Descriptor turned = shown(turn);
    for (const Feature f :
         {Feature::kLength, Feature::kWidth, Feature::kHeight, Feature::kTop, Feature::kSpread1,
          Feature::kSpread2, Feature::kSpread3, Feature::kRange, Feature::kIsolation,
          Feature::kAspect, Feature::kRoughness, Feature::kHoles, Feature::kFill,
          Feature::kEdgeShare, Feature::kCut})
      EXPECT_NEAR(value(turned, f), value(ahead, f), 0.15)
          << turn << ": " << featureNames()[static_cast<std::size_t>(f)];
    EXPECT_EQ(value(turned, Feature::kLogReturns), value(ahead, Feature::kLogReturns));
  }
}

TEST(ClusterDescriptor, ASingleReturnHasFiniteFeatures) {
  SolidScene scene;
  scene.cylinders = {{{10, 0}, 0.25, 0, 1.75}};
  ObstacleScan scan(scene);
  const auto members = scan.within(9, 11, -1, 1);
  ASSERT_FALSE(members.empty());
  const Descriptor d = scan.describe(std::vector<std::uint32_t>{members[0]});
  for (std::size_t k = 0; k < kFeatures; ++k) EXPECT_TRUE(std::isfinite(d[k])) << featureNames()[k];
  EXPECT_EQ(value(d, Feature::kLength), 0);
  EXPECT_EQ(value(d, Feature::kRows), 1);
  EXPECT_EQ(value(d, Feature::kColumns), 1);
}

}  // namespace
}  // namespace perception
