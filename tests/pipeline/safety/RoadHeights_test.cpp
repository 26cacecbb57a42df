#include "libperception/pipeline/safety/RoadHeights.h"

#include <gtest/gtest.h>

#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"

namespace perception {
namespace {

Corridor straight(bool backward) {
  Corridor corridor;
  corridor.backward = backward;
  corridor.max = 30;
  return corridor;
}

TEST(RoadHeights, AreLinearBetweenReturnsAndLevelBehindThem) {
  for (const float ahead : {1.0F, -1.0F}) {
    RoadHeights heights(ahead < 0);
    heights.add(ahead * 10.5F, 0.2F, 1);
    heights.add(ahead * 20.5F, 0.2F, 3);
    heights.add(ahead * 25.5F, 9, 7);     // beside the lane
    heights.add(ahead * -5.5F, 0.2F, 7);  // not on the way
    Corridor corridor = straight(ahead < 0);
    corridor.road = heights.along(corridor);
    EXPECT_NEAR(corridor.roadAt(0), 0, 1e-6);
    EXPECT_NEAR(corridor.roadAt(5), 0.5, 1e-6);
    EXPECT_NEAR(corridor.roadAt(15), 2, 1e-6);
    EXPECT_NEAR(corridor.roadAt(28), 3, 1e-6);
    EXPECT_NEAR(corridor.roadAt(100), 3, 1e-6);
  }
}

TEST(RoadHeights, SayHowFarBackTheRoadWasSeen) {
  RoadHeights heights;
  heights.add(10.5F, 0.2F, 0), heights.add(20.5F, 0.2F, 0);
  std::vector<float> unseen;
  heights.along(straight(false), &unseen);
  ASSERT_EQ(unseen.size(), 32u);
  EXPECT_EQ(unseen[8], 0) << "the vehicle stands on it";
  EXPECT_EQ(unseen[10], 0);
  EXPECT_EQ(unseen[14], 4);
  EXPECT_EQ(unseen[20], 0);
  EXPECT_EQ(unseen[31], 11);
}

TEST(RoadHeights, AreLevelWithoutReturns) {
  Corridor corridor = straight(false);
  corridor.road = RoadHeights().along(corridor);
  EXPECT_EQ(corridor.roadAt(20), 0);
}

TEST(RoadHeights, WhatIsSeenIsSeenAboveTheRoad) {
  Corridor corridor = straight(false);
  GridPoints ends;
  for (double x = 5; x < 30; x += 0.5) ends.push_back({x, 0, 0.15 * x});  // a road that rises
  const Vector3 lidar(0, 0, 1.7);
  EXPECT_LT(seenByBeams(corridor, 2.5, lidar, {&ends}, 1.7), 15);
  for (int s = 0; s < 31; ++s) corridor.road.push_back(0.15F * static_cast<float>(s));
  EXPECT_GT(seenByBeams(corridor, 2.5, lidar, {&ends}, 1.7), 18);
}

}  // namespace
}  // namespace perception
