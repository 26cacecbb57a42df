#include "libperception/pipeline/safety/Clearance.h"

#include <gtest/gtest.h>

#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/grid/GridParams.h"
#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

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
