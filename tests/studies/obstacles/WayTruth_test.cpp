#include "studies/obstacles/WayTruth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

constexpr Stamp kStart{1'577'836'800'000'000'000};

/// Twelve returns at `x` [m] ahead; ego and world frame are one.
LabeledObstacles thingAt(double x, bool phantom) {
  LabeledObstacles found;
  for (int i = 0; i < 12; ++i) {
    found.place.emplace_back(x, 0.05 * i, 1);
    found.x.push_back(static_cast<float>(x));
    found.y.push_back(0.05F * static_cast<float>(i));
    found.z.push_back(1);
    found.phantom.push_back(phantom);
    found.surface.push_back(!phantom);
  }
  return found;
}

const TruthSpeeds& standing() {
  static const TruthSpeeds speeds("/no/such.rawlog");
  return speeds;
}

StopRule ruleAt(double speed) {
  StopRule rule;
  rule.speed = speed;
  rule.speeds = &standing();
  return rule;
}

TEST(WayTruth, ASurfaceForThreeScansIsInTheWay) {
  WayTruth truth;
  std::vector<InTheWay> judged;
  for (int i = 0; i < 3; ++i) {
    truth.add(kStart + 0.1 * i, 0.1 * i, thingAt(10, false), standing());
    judged.push_back(truth.judge(kStart + 0.1 * i, ruleAt(10)));
  }
  EXPECT_EQ(judged,
            (std::vector<InTheWay>{InTheWay::kPerhaps, InTheWay::kPerhaps, InTheWay::kYes}));
}

TEST(WayTruth, PhantomsAreNot) {
  WayTruth truth;
  truth.add(kStart, 0, thingAt(10, true), standing());
  EXPECT_EQ(truth.judge(kStart, ruleAt(10)), InTheWay::kNo);
}

TEST(WayTruth, WhatWasThereHalfASecondAgoPerhapsIs) {
  WayTruth truth;
  truth.add(kStart, 0, thingAt(10, false), standing());
  truth.add(kStart + 0.5, 0.5, {}, standing());
  EXPECT_EQ(truth.judge(kStart + 0.5, ruleAt(10)), InTheWay::kPerhaps);
  truth.add(kStart + 0.7, 0.7, {}, standing());
  EXPECT_EQ(truth.judge(kStart + 0.7, ruleAt(10)), InTheWay::kNo);
}

TEST(WayTruth, BeyondTheStoppingDistanceNothingIsInTheWay) {
  WayTruth truth;
  truth.add(kStart, 0, thingAt(40, false), standing());
  EXPECT_EQ(truth.judge(kStart, ruleAt(5)), InTheWay::kNo);
}

TEST(WayTruth, AClusterTakesTenReturns) {
  LabeledObstacles thing = thingAt(10, true);
  EXPECT_NEAR(nearestCluster(thing, {}).s, 10, 1e-6);
  EXPECT_NEAR(nearestInCorridor(thing.place, {}).s, 10, 1e-6);
  for (auto* v : {&thing.x, &thing.y, &thing.z}) v->resize(9);
  EXPECT_TRUE(std::isinf(nearestCluster(thing, {}).s));
}

TEST(TruthSpeeds, AreThoseOfTheObjectAtThePlace) {
  const test::TemporaryFolder folder;
  TruthObject car;
  car.frame = 0;
  car.type = "Car";
  car.position = {20, 0, 0};
  car.length = 4, car.width = 2, car.height = 1.5;
  car.vx = 7, car.vy = 0;
  writeGroundTruth(folder.path() + "/a.truth.csv", {car});
  const TruthSpeeds speeds(folder.path() + "/a.rawlog");
  EXPECT_EQ(speeds.at(0, {18.2, 0.5, 1}), Vector2(7, 0));
  EXPECT_EQ(speeds.at(0, {10, 0, 1}), Vector2(0, 0));
  EXPECT_EQ(speeds.at(1, {20, 0, 1}), Vector2(0, 0));  // no truth at that time
}

}  // namespace
}  // namespace perception
