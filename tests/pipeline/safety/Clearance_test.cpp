#include "libperception/pipeline/safety/Clearance.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/grid/GridParams.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"
#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

constexpr double kTen = 10;  // returns that block the way

Corridor lane() {
  Corridor corridor;
  corridor.width = 2.2;
  corridor.max = 40;
  return corridor;
}

/// Rows of returns 0.05 m apart across the lane: an upright face 0.6 m wide, 12 m ahead.
GridPoints face(double from, double to, double rise = 0.06, double left = 0) {
  GridPoints points;
  for (double z = from; z <= to + 1e-6; z += rise)
    for (double y = left - 0.3; y <= left + 0.3; y += 0.05) points.push_back({12, y, z});
  return points;
}

TEST(Clearance, SomeoneLyingOnTheRoadBlocksTheWay) {
  const LowObstacle found = lowObstacle(lane(), {}, {}, face(0.06, 0.24), kTen);
  EXPECT_TRUE(found.free.blocked);
  EXPECT_NEAR(found.free.distance, 12, 1e-6);
  EXPECT_GE(found.returns, 10u);
}

TEST(Clearance, WhatACarPassesOverDoesNot) {
  EXPECT_FALSE(lowObstacle(lane(), {}, {}, face(0, 0.18), kTen).free.blocked) << "a kerb";
}

TEST(Clearance, BesideTheWayTheyDoNotMatter) {
  EXPECT_FALSE(lowObstacle(lane(), {}, {}, face(0.06, 0.24, 0.06, 2), kTen).free.blocked);
}

// Of a road that the ground's model misses, a half meter rises by less than a tenth of a meter.
TEST(Clearance, ARoadThatRisesBySevenPercentMoreThanItsModelIsNone) {
  for (const double slope : {0.07, 0.15}) {
    GridPoints road;
    for (double x = 5; x < 30; x += 0.05)
      for (double y = -1; y <= 1; y += 0.1) road.push_back({x, y, slope * (x - 10)});
    EXPECT_FALSE(lowObstacle(lane(), {}, {}, road, kTen).free.blocked) << slope;
  }
}

TEST(Clearance, StandOnTheRoadThatTheyAreOn) {
  Corridor hill = lane();
  GridPoints lying, kerb;
  for (int s = 0; s < 42; ++s) hill.road.push_back(0.1F * static_cast<float>(s));
  for (std::size_t i = 0; i < face(0.06, 0.24).size(); ++i)
    lying.push_back(face(0.06, 0.24)[i] + Vector3(0, 0, 1.2));
  for (std::size_t i = 0; i < face(0, 0.18).size(); ++i)
    kerb.push_back(face(0, 0.18)[i] + Vector3(0, 0, 1.2));
  EXPECT_TRUE(lowObstacle(hill, {}, {}, lying, kTen).free.blocked);
  EXPECT_FALSE(lowObstacle(hill, {}, {}, kerb, kTen).free.blocked);
}

TEST(Clearance, TheFootOfAnObstacleCountsWithIt) {
  GridPoints top, foot;
  for (double y = -0.15; y <= 0.15; y += 0.05)
    top.push_back({12, y, 0.4}), foot.push_back({12, y, 0.15});
  ASSERT_LT(top.size(), 10u);
  EXPECT_TRUE(lowObstacle(lane(), top, {}, foot, kTen).free.blocked);
  EXPECT_FALSE(lowObstacle(lane(), {}, {}, foot, kTen).free.blocked);
  const std::vector<float> doubted(top.size(), 0);
  EXPECT_FALSE(lowObstacle(lane(), top, doubted, foot, kTen).free.blocked);
}

TEST(Clearance, BeamsEndACellAndAHalfBehindWhatHangsHigh) {
  SensorFrame frame;
  frame.T_ego_sensor = makePose(0, 0, 1.7, 0);
  PlacedReturns returns;
  returns.height_max = 3;
  const auto add = [&](float x, float z, float height) {
    returns.x.push_back(x), returns.y.push_back(0), returns.z.push_back(z);
    returns.height.push_back(height);
  };
  add(10, 1.7F, 2.3F);  // above a road that falls
  add(10, 1.7F, 1.7F);  // lower than the vehicle
  add(10, 4, 4);        // above all cells
  GridScan scan;
  clearOverhead(frame, returns, 2, 0.2, scan);
  ASSERT_EQ(scan.clear.size(), 1u);
  EXPECT_NEAR((scan.clear[0] - Vector3(10.3, 0, 1.7)).norm(), 0, 1e-5);
  EXPECT_TRUE(scan.hits.empty());
}

/// The path 20 m before returns one meter wide, after scans in which each of the rows has its
/// height above the vehicle's plane and that above the road.
struct RowHeights {
  float level, height;
};
PathAhead pathAfter(SafetyMonitor& monitor, int scans, const std::vector<RowHeights>& rows) {
  PathAhead path;
  for (int k = 0; k < scans; ++k) {
    SensorFrame frame;
    frame.stamp = frame.ego.stamp = test::kStart;
    frame.ego.velocity = {5, 0};
    frame.T_ego_sensor = makePose(0, 0, 1.7, 0);
    frame.data = LidarCloud{};
    PlacedReturns returns;
    returns.height_min = 0.3, returns.height_max = 3;
    const auto add = [&](float x, float y, const RowHeights& row) {
      returns.x.push_back(x), returns.y.push_back(y), returns.z.push_back(row.level);
      returns.height.push_back(row.height);
    };
    for (float y = -0.5F; y <= 0.5F; y += 0.1F)
      for (const RowHeights& row : rows) add(20, y, row);
    for (float road = 4; road < 20; road += 0.2F) add(road, 0, {0, 0});
    monitor.add(frame, returns);
    path = monitor.pathAhead(frame.ego);
  }
  return path;
}

SafetyMonitor monitorOfSixtyMeters() {
  GridParams grid;
  grid.size = 60;
  return {grid, {}};
}

TEST(Clearance, SomeoneLyingOnTheRoadCallsForAStop) {
  SafetyMonitor monitor = monitorOfSixtyMeters();
  const PathAhead path = pathAfter(monitor, 1, {{0.06F, 0.06F}, {0.15F, 0.15F}, {0.24F, 0.24F}});
  EXPECT_TRUE(path.free.blocked);
  EXPECT_TRUE(path.by_returns);
  EXPECT_NEAR(path.free.distance, 20, 0.1);
  EXPECT_GE(path.returns, 10u);
}

TEST(Clearance, ACeilingThatTurnsOutToHangHighIsPassedUnder) {
  SafetyMonitor monitor = monitorOfSixtyMeters();
  EXPECT_TRUE(pathAfter(monitor, 5, {{1.85F, 1.85F}}).free.blocked);
  EXPECT_FALSE(pathAfter(monitor, 8, {{1.85F, 2.3F}}).free.blocked);
}

TEST(Clearance, WhatHangsLowerInTheSameCellStays) {
  SafetyMonitor monitor = monitorOfSixtyMeters();
  EXPECT_TRUE(pathAfter(monitor, 5, {{1.85F, 1.85F}, {1.95F, 1.95F}}).free.blocked);
  EXPECT_TRUE(pathAfter(monitor, 8, {{1.85F, 1.95F}, {1.95F, 2.3F}}).free.blocked);
}

}  // namespace
}  // namespace perception
