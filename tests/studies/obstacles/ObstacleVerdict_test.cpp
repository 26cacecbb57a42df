#include "studies/obstacles/ObstacleVerdict.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

constexpr auto kAdvice = StopCaller::kAdvice, kClusters = StopCaller::kClusters;

/// A scene with the shape `gap` [m] ahead, shown with ten returns as high as obstacles.
ObstacleMoment shownAt(double gap, bool advice, bool clusters) {
  static int scene = 0;
  ObstacleMoment moment;
  moment.stamp = Stamp::fromSeconds(0.1 * ++scene);
  moment.gap = moment.shown = moment.standing = moment.told = gap;
  moment.needed = 18.5;
  moment.stops = {advice, clusters};
  return moment;
}

TEST(ObstacleVerdict, ACallInTheFirstSceneIsInTime) {
  ObstacleVerdict verdict(ShapeDemand::kStop);
  verdict.add(shownAt(25, false, false));
  EXPECT_FALSE(verdict.shownWithin());
  EXPECT_FALSE(verdict.done());
  verdict.add(shownAt(18, true, false));
  EXPECT_TRUE(verdict.shownWithin());
  EXPECT_EQ(verdict.shown_at, 25);
  EXPECT_EQ(verdict.of(kAdvice).called_at, 18);
  EXPECT_FALSE(verdict.missed(kAdvice));
  EXPECT_FALSE(verdict.late(kAdvice, 0));
  EXPECT_TRUE(verdict.missed(kClusters));
  verdict.add(shownAt(17, false, true));
  EXPECT_TRUE(verdict.done());
  EXPECT_TRUE(verdict.late(kClusters, 0));
  EXPECT_FALSE(verdict.late(kClusters, 1));
  EXPECT_EQ(verdict.of(kAdvice).silent, 0u) << "it had called";
}

TEST(ObstacleVerdict, SilenceHasACause) {
  ObstacleVerdict verdict(ShapeDemand::kStop);
  ObstacleMoment low = shownAt(15, false, false), ground = low, doubt = low;
  low.standing = low.told = ObstacleMoment::kNone;
  ground.told = ObstacleMoment::kNone;
  verdict.add(low), verdict.add(ground), verdict.add(doubt), verdict.add(doubt);
  EXPECT_EQ(verdict.silent_by_cause, (std::array<std::size_t, kSilenceCauses>{1, 1, 2}));
  EXPECT_EQ(verdict.of(kAdvice).silent, 4u);
  EXPECT_TRUE(verdict.missed(kAdvice));
}

TEST(ObstacleVerdict, AtTheBorderNeitherSilenceNorAStopCounts) {
  ObstacleVerdict verdict(ShapeDemand::kStop);
  verdict.add(shownAt(18.3, false, false));
  verdict.add(shownAt(19.3, true, true));
  EXPECT_EQ(verdict.of(kAdvice).silent, 0u);
  EXPECT_EQ(verdict.of(kAdvice).stops.falsely.scans, 0u);
  verdict.add(shownAt(19.7, true, false));
  EXPECT_EQ(verdict.of(kAdvice).stops.falsely.scans, 1u);
  EXPECT_EQ(verdict.of(kClusters).stops.falsely.scans, 0u);
}

TEST(ObstacleVerdict, WhatIsBesideTheWayIsNoReasonToStop) {
  ObstacleVerdict verdict(ShapeDemand::kPass);
  verdict.add(shownAt(5, true, false));
  EXPECT_EQ(verdict.of(kAdvice).stops.falsely.stops, 1u);
  EXPECT_FALSE(verdict.shownWithin());
  EXPECT_FALSE(verdict.done());
}

TEST(ObstacleVerdict, WhatIsLowMayBeCalledOrNot) {
  ObstacleVerdict verdict(ShapeDemand::kLow);
  verdict.add(shownAt(5, false, true));
  EXPECT_EQ(verdict.of(kAdvice).silent, 0u);
  EXPECT_EQ(verdict.of(kClusters).stops.falsely.stops, 0u);
  EXPECT_FALSE(verdict.shownWithin());
}

TEST(ObstacleVerdict, TenReturnsWithinHalfAMeterAreNeeded) {
  std::vector<double> distances = {3, 9};
  for (int i = 0; i < 9; ++i) distances.push_back(7 + 0.05 * i);
  EXPECT_TRUE(std::isinf(nearestTen(distances)));
  distances.push_back(7.45);
  EXPECT_EQ(nearestTen(distances), 7);
}

}  // namespace
}  // namespace perception
