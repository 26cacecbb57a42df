#include "libperception/pipeline/safety/WayReturns.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"
#include "libperception/measurement/frames/PhantomCauses.h"
#include "libperception/measurement/frames/WakeMap.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

constexpr double kTen = 10;     // returns that block the way
constexpr double kRecent = 30;  // [m] up to which those of half a second count
const GridPoints kNone;

/// Of clear air, or of snow.
PhantomCauses causesIn(bool clear) {
  PhantomCauses causes;
  causes.weather = clear ? 0 : 0.5;
  return causes;
}

Corridor lane() {
  Corridor corridor;
  corridor.width = 2.2;
  corridor.max = 40;
  return corridor;
}

/// What one scan shows; `clear`: in clear air.
ReturnObstacle ofOneScan(const Corridor& corridor, const GridPoints& hits,
                         const std::vector<float>& weights, const GridPoints& others,
                         bool clear = true) {
  WayReturns way;
  way.add(test::kStart, corridor, {}, hits, weights, others, causesIn(clear));
  return way.nearest(corridor, kRecent, kTen);
}
bool blocks(const Corridor& corridor, const GridPoints& hits, const std::vector<float>& weights,
            const GridPoints& others, bool clear = true) {
  return ofOneScan(corridor, hits, weights, others, clear).free.blocked;
}

GridPoints wallAt(double x, int returns, double spacing = 0.03) {
  GridPoints points;
  for (int i = 0; i < returns; ++i) points.push_back({x + spacing * i, 0.1 * (i % 5), 1});
  return points;
}

TEST(WayReturns, TenReturnsOfOneScanBlockTheWay) {
  for (const bool clear : {false, true}) {
    const ReturnObstacle found = ofOneScan(lane(), wallAt(20, 10), {}, kNone, clear);
    EXPECT_TRUE(found.free.blocked);
    EXPECT_NEAR(found.free.distance, 20, 1e-5);
    EXPECT_NEAR(found.free.place.x(), 20, 1e-5);
    EXPECT_EQ(found.returns, 10u);
    EXPECT_FALSE(blocks(lane(), wallAt(20, 9), {}, kNone, clear));
  }
}

// A pole that points toward the vehicle, or a plank.
TEST(WayReturns, InClearAirTheyMayBeSpreadAlongTheWay) {
  EXPECT_TRUE(blocks(lane(), wallAt(20, 10, 0.3), {}, kNone));
  EXPECT_FALSE(blocks(lane(), wallAt(20, 10, 0.6), {}, kNone));
  EXPECT_FALSE(blocks(lane(), wallAt(20, 10, 0.1), {}, kNone, false)) << "0.9 m deep";
}

TEST(WayReturns, CountByTheirWeight) {
  const std::vector<float> doubted(12, 0.8F), trusted(12, 0.9F);
  for (const bool clear : {false, true}) {
    EXPECT_FALSE(blocks(lane(), wallAt(20, 12), doubted, kNone, clear));
    EXPECT_TRUE(blocks(lane(), wallAt(20, 12), trusted, kNone, clear));
  }
}

TEST(WayReturns, WhatIsBesideTheCorridorOrBeyondItDoesNotCount) {
  Corridor corridor = lane();
  GridPoints beside;
  for (int i = 0; i < 50; ++i) beside.push_back({20, 1.2, 0.02 * i});
  EXPECT_FALSE(blocks(corridor, beside, {}, kNone));
  corridor.max = 19;
  EXPECT_FALSE(blocks(corridor, wallAt(20, 50, 0.001), {}, kNone));
}

/// Scans 0.1 s apart with as many returns each.
ReturnObstacle ofScans(const std::vector<int>& returns, bool clear, double speed = 0,
                       double x = 20) {
  WayReturns way;
  for (std::size_t k = 0; k < returns.size(); ++k) {
    const double t = 0.1 * static_cast<double>(k);
    way.add(test::kStart + t, lane(), {}, wallAt(x + speed * t, returns[k]), {}, kNone,
            causesIn(clear));
  }
  return way.nearest(lane(), kRecent, kTen);
}

TEST(WayReturns, InClearAirWhatFewBeamsHitIsSeenInHalfASecond) {
  EXPECT_TRUE(ofScans({2, 2, 2, 2, 2}, true).free.blocked);
  EXPECT_FALSE(ofScans({2, 2, 2, 2}, true).free.blocked);
  EXPECT_FALSE(ofScans({2, 2, 2, 2, 2}, false).free.blocked);
  EXPECT_FALSE(ofScans({9, 0, 0, 0, 0, 2}, true).free.blocked) << "older";
  EXPECT_FALSE(ofScans({9, 9, 9, 9, 9}, true, 0, 31).free.blocked) << "farther than is asked for";
}

TEST(WayReturns, OfWhatHasLeftOneReturnIsNoObstacle) {
  EXPECT_FALSE(ofScans({60, 60, 60, 60, 1}, true).free.blocked) << "a car was there, now a drop is";
  EXPECT_TRUE(ofScans({9, 9, 9, 9, 1}, true).free.blocked) << "a thin one is hit by chance";
  EXPECT_TRUE(ofScans({20, 20, 20, 20, 5}, true).free.blocked) << "it is partly hidden";
}

// The cloud behind a car ends the memory where it hangs, and nowhere else.
TEST(WayReturns, AWakeMattersWhereItIs) {
  const auto blockedBeside = [](double wake_y) {
    auto wakes = std::make_shared<WakeMap>();
    WayReturns way;
    for (int k = 0; k < 10; ++k) {
      VehicleFootprint car;
      car.stamp = test::kStart + 0.1 * k;
      car.center = {18 + k, wake_y};
      car.speed = 10, car.advanced = 1, car.half_length = 1, car.half_width = 0.9;
      wakes->add(car);
      PhantomCauses causes;
      causes.wakes = std::make_shared<WakeMap>(*wakes);
      way.add(car.stamp, lane(), {}, wallAt(20, 2), {}, kNone, causes);
    }
    return way.nearest(lane(), kRecent, kTen).free.blocked;
  };
  EXPECT_TRUE(blockedBeside(6));
  EXPECT_FALSE(blockedBeside(0));
}

TEST(WayReturns, WhatTheNewestScanDoesNotShowHasLeft) {
  EXPECT_FALSE(ofScans({9, 9, 9, 9, 0}, true).free.blocked);
  const ReturnObstacle ahead = ofScans({9, 9, 9, 9, 9}, true, 4);
  EXPECT_TRUE(ahead.free.blocked);
  EXPECT_NEAR(ahead.free.distance, 21.6, 1e-5);
}

/// Rows of returns 0.05 m apart across the lane: an upright face 0.6 m wide, 12 m ahead.
GridPoints face(double from, double to, double rise = 0.06, double left = 0) {
  GridPoints points;
  for (double z = from; z <= to + 1e-6; z += rise)
    for (double y = left - 0.3; y <= left + 0.3; y += 0.05) points.push_back({12, y, z});
  return points;
}

TEST(WayReturns, SomeoneLyingOnTheRoadBlocksTheWay) {
  const ReturnObstacle found = ofOneScan(lane(), kNone, {}, face(0.06, 0.24));
  EXPECT_TRUE(found.free.blocked);
  EXPECT_NEAR(found.free.distance, 12, 1e-6);
  EXPECT_GE(found.returns, 10u);
  EXPECT_FALSE(blocks(lane(), kNone, {}, face(0.06, 0.24), false)) << "in weather";
}

// A lidar of few beams: one row a scan, each time at another height.
TEST(WayReturns, SomeoneLyingIsSeenByOneRowAfterTheOther) {
  WayReturns way;
  for (int k = 0; k < 4; ++k) {
    const double z = 0.24 - 0.06 * k;
    const GridPoints row = face(z, z);
    EXPECT_FALSE(blocks(lane(), kNone, {}, row));
    way.add(test::kStart + 0.1 * k, lane(), {}, kNone, {}, row, {});
  }
  EXPECT_TRUE(way.nearest(lane(), kRecent, kTen).free.blocked);
}

TEST(WayReturns, WhatACarPassesOverDoesNotBlock) {
  EXPECT_FALSE(blocks(lane(), kNone, {}, face(0, 0.18))) << "a kerb";
}

TEST(WayReturns, BesideTheWayLowReturnsDoNotMatter) {
  EXPECT_FALSE(blocks(lane(), kNone, {}, face(0.06, 0.24, 0.06, 2)));
}

// Of a road that the ground's model misses, a half meter rises by less than a tenth of a meter.
TEST(WayReturns, ARoadThatRisesBySevenPercentMoreThanItsModelIsNone) {
  for (const double slope : {0.07, 0.15}) {
    GridPoints road;
    for (double x = 5; x < 30; x += 0.05)
      for (double y = -1; y <= 1; y += 0.1) road.push_back({x, y, slope * (x - 10)});
    EXPECT_FALSE(blocks(lane(), kNone, {}, road)) << slope;
  }
}

// A spot of the own bonnet above a road that seems 0.06 to 0.13 m too high.
TEST(WayReturns, WhatIsHighAboveTheRoadDoesNotMakeItStandUp) {
  GridPoints bonnet, road;
  bonnet.push_back({2.5, 0.4, 0.8});
  for (double x = 2.3; x < 4; x += 0.05) road.push_back({x, 0.4, 0.06 + 0.04 * (x - 2.3)});
  EXPECT_FALSE(blocks(lane(), bonnet, {}, road));
}

TEST(WayReturns, StandOnTheRoadThatTheyAreOn) {
  Corridor hill = lane();
  GridPoints lying, kerb;
  for (int s = 0; s < 42; ++s) hill.road.push_back(0.1F * static_cast<float>(s));
  for (std::size_t i = 0; i < face(0.06, 0.24).size(); ++i)
    lying.push_back(face(0.06, 0.24)[i] + Vector3(0, 0, 1.2));
  for (std::size_t i = 0; i < face(0, 0.18).size(); ++i)
    kerb.push_back(face(0, 0.18)[i] + Vector3(0, 0, 1.2));
  EXPECT_TRUE(blocks(hill, kNone, {}, lying));
  EXPECT_FALSE(blocks(hill, kNone, {}, kerb));
}

TEST(WayReturns, TheFootOfAnObstacleCountsWithIt) {
  GridPoints top, foot;
  for (double y = -0.15; y <= 0.15; y += 0.05)
    top.push_back({12, y, 0.4}), foot.push_back({12, y, 0.15});
  ASSERT_LT(top.size(), 10u);
  EXPECT_TRUE(blocks(lane(), top, {}, foot));
  EXPECT_FALSE(blocks(lane(), kNone, {}, foot));
  const std::vector<float> doubted(top.size(), 0);
  EXPECT_FALSE(blocks(lane(), top, doubted, foot));
}

/// The newest of scans 0.1 s apart, each a row of three returns 1 m high where a beam meets the
/// upper side of a board 7 m ahead.
ReturnObstacle alongABoard(double speed, int scans) {
  WayReturns way;
  Corridor corridor = lane();
  for (int k = 0; k < scans; ++k) {
    corridor.T_world_ego = makePose(0.1 * speed * k, 0, 0, 0);
    GridPoints row;
    for (const double y : {-0.05, 0.0, 0.05}) row.push_back({0.1 * speed * k + 7, y, 1});
    way.add(test::kStart + 0.1 * k, corridor, {}, row, {}, kNone, {});
  }
  return way.nearest(corridor, kRecent, kTen);
}

TEST(WayReturns, ABeamMayPassAlongASurfaceAsFastAsTheVehicleDrives) {
  EXPECT_TRUE(alongABoard(6, 4).free.blocked);
  EXPECT_TRUE(alongABoard(10, 4).free.blocked);
  EXPECT_FALSE(alongABoard(6, 3).free.blocked) << "nine returns";
  EXPECT_FALSE(alongABoard(20, 5).free.blocked) << "that far apart they are of several things";
}

/// Rows of hits 12 m ahead, one a scan; the road was last seen as far before them.
bool blocksBehind(double unseen, const std::vector<double>& heights) {
  WayReturns way;
  for (std::size_t k = 0; k < heights.size(); ++k)
    way.add(test::kStart + 0.1 * static_cast<double>(k), lane(),
            std::vector<float>(42, static_cast<float>(unseen)), face(heights[k], heights[k]), {},
            kNone, {});
  return way.nearest(lane(), kRecent, kTen).free.blocked;
}

// A lidar of few beams shows hills by one row of returns, far behind the last one on the road.
TEST(WayReturns, WhereTheRoadMayRiseUnseenHitsHaveToStandUp) {
  EXPECT_FALSE(blocksBehind(10, {0.8}));
  EXPECT_FALSE(blocksBehind(10, {0.8, 0.83, 0.86}));
  EXPECT_TRUE(blocksBehind(10, {0.8, 0.85, 0.91})) << "a beam that goes up a face";
  EXPECT_TRUE(blocksBehind(5, {0.8})) << "the road was seen close before it";
}

}  // namespace
}  // namespace perception
