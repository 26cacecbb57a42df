#include "libperception/grid/StopAdvice.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(StopAdvice, TheStoppingDistanceIsReactionBrakingAndMargin) {
  StopParams p;
  p.reaction = 0.5, p.deceleration = 4, p.margin = 1;
  EXPECT_DOUBLE_EQ(stoppingDistance(10, 0, p), 5 + 12.5 + 1);
  EXPECT_DOUBLE_EQ(stoppingDistance(0, 0, p), 1);
}

TEST(StopAdvice, WhatDrivesAheadAsFastAsksForTheReactionAlone) {
  const StopParams p;
  EXPECT_DOUBLE_EQ(stoppingDistance(10, 10, p), 10 * p.reaction + p.margin);
  EXPECT_DOUBLE_EQ(stoppingDistance(10, 30, p), p.margin);
}

TEST(StopAdvice, WhatComesTowardTheVehicleCountsAsStanding) {
  const StopParams p;
  EXPECT_DOUBLE_EQ(stoppingDistance(10, -8, p), stoppingDistance(10, 0, p));
}

TEST(StopAdvice, TheCorridorFollowsTheDrivenArc) {
  const StopParams p;
  const Corridor left = drivenCorridor(Pose3::Identity(), 10, 0.5, 2.4, p);
  EXPECT_DOUBLE_EQ(left.curvature, 0.05);
  EXPECT_DOUBLE_EQ(left.from, 2.4);
  EXPECT_DOUBLE_EQ(left.width, p.width);
  EXPECT_DOUBLE_EQ(drivenCorridor(Pose3::Identity(), 3, -3, 2.4, p).curvature, -p.sharpest);
}

TEST(StopAdvice, AVehicleThatHardlyMovesLooksStraightAhead) {
  EXPECT_DOUBLE_EQ(drivenCorridor(Pose3::Identity(), 0.5, 0.2, 2.4, {}).curvature, 0);
}

}  // namespace
}  // namespace perception
