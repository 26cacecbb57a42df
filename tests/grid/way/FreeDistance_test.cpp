#include "libperception/grid/way/FreeDistance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

const auto kAllKnown = [](const Vector3&) { return -1.0; };

GridCell cellAt(double x, double y) { return {{x, y, 1}, Vector3::Constant(0.2), 3}; }

TEST(ArcPlace, QuarterTurnLeftEndsBesideTheCenter) {
  Corridor corridor;
  corridor.curvature = 0.1;
  const ArcPlace place = arcPlace(corridor, 10, 10);
  EXPECT_NEAR(place.s, 10 * kPi / 2, 1e-12);
  EXPECT_NEAR(place.d, 0, 1e-12);
}

TEST(ArcPlace, RightTurnIsTheMirrorImageOfALeftTurn) {
  Corridor left, right;
  left.curvature = 0.05;
  right.curvature = -0.05;
  const ArcPlace a = arcPlace(left, 7, 3), b = arcPlace(right, 7, -3);
  EXPECT_NEAR(a.s, b.s, 1e-12);
  EXPECT_NEAR(a.d, -b.d, 1e-12);
}

TEST(AreaOf, HoldsWhatIsHalfAMeterFromTheCorridorHoweverItBends) {
  for (const double curvature : {0.0, 0.02, -0.08, 0.3, -0.9}) {
    Corridor corridor;
    corridor.T_world_ego = makePose(200, -80, 1, 2.2, radians(3), radians(-2));
    corridor.curvature = curvature;
    corridor.max = 40;
    const GridArea area = areaOf(corridor);
    for (double s = corridor.from - 0.5; s <= corridor.max + 0.5; s += 0.07) {
      for (const double d : {-corridor.width / 2 - 0.5, 0.0, corridor.width / 2 + 0.5}) {
        const Vector2 p = onArc(corridor, {s, d});
        for (const double z : {0.0, 2.5})
          EXPECT_TRUE(area.holds(corridor.T_world_ego * Vector3(p.x(), p.y(), z)))
              << curvature << " " << s << " " << d;
      }
    }
    EXPECT_LT(area.x_max - area.x_min, 50);
  }
}

TEST(ArcPlace, OnArcIsItsInverse) {
  for (const double k : {-0.1, 0.0, 0.04}) {
    Corridor corridor;
    corridor.curvature = k;
    const Vector2 p = onArc(corridor, arcPlace(corridor, 9, 2.5));
    EXPECT_NEAR(p.x(), 9, 1e-9);
    EXPECT_NEAR(p.y(), 2.5, 1e-9);
  }
}

TEST(ArcPlace, AlmostStraightAgreesWithStraight) {
  Corridor straight, bent;
  bent.curvature = 2e-6;
  const ArcPlace a = arcPlace(straight, 30, 1), b = arcPlace(bent, 30, 1);
  EXPECT_NEAR(a.s, b.s, 1e-3);
  EXPECT_NEAR(a.d, b.d, 1e-3);
}

TEST(FreeDistance, CountsTheNearSideOfTheFirstCellInTheCorridor) {
  const std::vector<GridCell> cells = {cellAt(30, 0), cellAt(12, 0.9), cellAt(8, 1.3)};
  const FreeDistance ahead = freeDistance({}, cells, 0.2, kAllKnown);
  EXPECT_TRUE(ahead.blocked);
  EXPECT_NEAR(ahead.distance, 11.9, 1e-9);
}

TEST(FreeDistance, TurnsWithTheVehicle) {
  Corridor corridor;
  corridor.T_world_ego = makePose(5, 5, 0, kPi / 2);
  EXPECT_NEAR(freeDistance(corridor, {cellAt(5, 15)}, 0.2, kAllKnown).distance, 9.9, 1e-9);
}

TEST(FreeDistance, IgnoresWhatLiesBehindAndUnderTheVehicle) {
  const std::vector<GridCell> cells = {cellAt(-10, 0), cellAt(1, 0)};
  const FreeDistance ahead = freeDistance({}, cells, 0.2, kAllKnown);
  EXPECT_FALSE(ahead.blocked);
  EXPECT_DOUBLE_EQ(ahead.distance, Corridor{}.max);
}

TEST(FreeDistance, SeenEndsWhereTheLidarHasNotLooked) {
  const auto known_to_20 = [](const Vector3& p) { return p.x() < 20 ? -1.0 : 0.0; };
  EXPECT_NEAR(freeDistance({}, {}, 0.2, known_to_20).seen, 20, 0.21);
}

TEST(FreeDistance, WhatIsKnownAboveAChildAloneIsNotSeen) {
  for (const double known_from : {0.4, 0.8, 1.1}) {
    const auto known = [&](const Vector3& p) { return p.z() > known_from ? -1.0 : 0.0; };
    const double seen = freeDistance({}, {}, 0.2, known).seen;
    EXPECT_EQ(seen > Corridor{}.max - 1, known_from < 1) << known_from;
  }
}

TEST(FreeDistance, SmallGapsBetweenBeamsDoNotEndWhatWasSeen) {
  const auto striped = [](const Vector3& p) { return std::fmod(p.x(), 0.9) < 0.3 ? -1.0 : 0.0; };
  EXPECT_GT(freeDistance({}, {}, 0.1, striped).seen, Corridor{}.max - 1);
}

TEST(FreeDistance, SeveralCellsWithinHalfAMeterBlockWhereTheCorridorAsksForThem) {
  Corridor corridor;
  corridor.cells = 3;
  const std::vector<GridCell> apart = {cellAt(10, 0), cellAt(10.4, 0), cellAt(11, 0)};
  EXPECT_FALSE(freeDistance(corridor, apart, 0.2, kAllKnown).blocked);
  const std::vector<GridCell> together = {cellAt(10, 0), cellAt(20, 0), cellAt(20.2, 0),
                                          cellAt(20.4, 0.2)};
  const FreeDistance found = freeDistance(corridor, together, 0.2, kAllKnown);
  EXPECT_TRUE(found.blocked);
  EXPECT_NEAR(found.distance, 19.9, 1e-9);
  EXPECT_NEAR(found.place.x(), 20, 1e-9);
}

/// Beams of a lidar 1.7 m above the road, one each half degree of elevation, that end on the road
/// or at `wall` [m] ahead.
GridPoints beamsAhead(double wall, double bearing = 0) {
  GridPoints ends;
  for (double elevation = radians(-20); elevation < radians(2); elevation += radians(0.5)) {
    const double road = elevation < 0 ? -1.7 / std::tan(elevation) : wall;
    const double range = std::min(road, wall);
    ends.emplace_back(range * std::cos(bearing), range * std::sin(bearing),
                      1.7 + range * std::tan(elevation));
  }
  return ends;
}

TEST(SeenByBeams, IsAsFarAsABeamReachesBetweenTheRoadAndTheVehiclesHeight) {
  Corridor corridor;
  corridor.max = 150;
  const GridPoints ends = beamsAhead(120);
  EXPECT_NEAR(seenByBeams(corridor, 40, {0, 0, 1.7}, {&ends}, 1.9), 120, 1.5);
  EXPECT_LT(seenByBeams(corridor, 40, {0, 0, 1.7}, {&ends}, 0.8), 120)
      << "a low vehicle must see lower";
}

// The level beam meets a wall, the lower one the road after 10 m.
TEST(SeenByBeams, ALidarOfTwoBeamsSeesNoFurtherThanAChildWouldBeHit) {
  Corridor corridor;
  corridor.max = 60;
  GridPoints ends;
  ends.emplace_back(10, 0, 0), ends.emplace_back(50, 0, 1.7);
  EXPECT_NEAR(seenByBeams(corridor, 5, {0, 0, 1.7}, {&ends}, 1.9), 9, 1);
}

TEST(SeenByBeams, BeamsBesideTheCorridorSayNothing) {
  Corridor corridor;
  corridor.max = 150;
  const GridPoints ends = beamsAhead(120, radians(5));  // 3.5 m to the side at 40 m
  EXPECT_EQ(seenByBeams(corridor, 40, {0, 0, 1.7}, {&ends}, 1.9), 40);
}

TEST(SeenByBeams, FollowsTheCorridorBackward) {
  Corridor corridor;
  corridor.backward = true;
  corridor.max = 100;
  const GridPoints behind = beamsAhead(70, kPi), ahead = beamsAhead(70);
  EXPECT_NEAR(seenByBeams(corridor, 10, {0, 0, 1.7}, {&ahead, &behind}, 1.9), 70, 1.5);
  EXPECT_EQ(seenByBeams(corridor, 10, {0, 0, 1.7}, {&ahead}, 1.9), 10);
}

}  // namespace
}  // namespace perception
