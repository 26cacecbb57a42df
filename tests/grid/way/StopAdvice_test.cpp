#include "libperception/grid/way/StopAdvice.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Angle.h"

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
  const Corridor left = drivenCorridor(Pose3::Identity(), {10, 0}, 0.5, 2.4, 2, p);
  EXPECT_DOUBLE_EQ(left.curvature, 0.05);
  EXPECT_DOUBLE_EQ(left.from, 2.4);
  EXPECT_DOUBLE_EQ(left.width, p.width);
  EXPECT_DOUBLE_EQ(drivenCorridor(Pose3::Identity(), {3, 0}, -3, 2.4, 2, p).curvature, -p.sharpest);
}

TEST(StopAdvice, AVehicleThatHardlyMovesLooksStraightAhead) {
  EXPECT_DOUBLE_EQ(drivenCorridor(Pose3::Identity(), {0.5, 0}, 0.2, 2.4, 2, {}).curvature, 0);
}

TEST(StopAdvice, AVehicleThatReversesLooksBehindAlongItsArc) {
  const StopParams p;
  // It heads to the west and drives to the east, while it turns left.
  const Pose3 west = makePose(5, 0, 0, kPi);
  const Corridor behind = drivenCorridor(west, {2, 0}, 0.2, 2.4, 2, p);
  EXPECT_TRUE(behind.backward);
  EXPECT_DOUBLE_EQ(behind.from, 2) << "its rear";
  EXPECT_DOUBLE_EQ(behind.curvature, 0.1);
  const Vector2 ego = onArc(behind, {3, 0});
  const Vector3 place = west * Vector3(ego.x(), ego.y(), 0);
  EXPECT_GT(place.x(), 7.5);
  EXPECT_GT(place.y(), 0.4) << "left of the direction of travel";
  const ArcPlace back = arcPlace(behind, ego.x(), ego.y());
  EXPECT_NEAR(back.s, 3, 1e-12);
  EXPECT_NEAR(back.d, 0, 1e-12);
}

TEST(StopAdvice, TheWayIsAsLongAsTheStoppingDistance) {
  const StopParams p;
  const Corridor fast = drivenCorridor(Pose3::Identity(), {36, 0}, 0, 2.4, 2, p);
  EXPECT_DOUBLE_EQ(fast.max, 2.4 + stoppingDistance(36, 0, p));
  EXPECT_DOUBLE_EQ(drivenCorridor(Pose3::Identity(), {5, 0}, 0, 2.4, 2, p).max, p.look_ahead);
}

TEST(StopAdvice, FromTheSafeSpeedTheVehicleStopsWithinTheWay) {
  const StopParams p;
  for (const double way : {2., 10., 40., 120.})
    for (const double along : {-5., 0., 8.})
      EXPECT_NEAR(stoppingDistance(safeSpeed(way, along, p), along, p), way, 1e-9);
  EXPECT_EQ(safeSpeed(0.9, 0, p), 0) << "the margin alone is longer";
}

}  // namespace
}  // namespace perception
