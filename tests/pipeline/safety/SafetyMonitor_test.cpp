#include "libperception/pipeline/safety/SafetyMonitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "tests/pipeline/safety/BoxAhead.h"

namespace perception {
namespace {

using namespace test;

SceneObject carAt(double x, double speed) {
  SceneObject car;
  car.id = 4;
  car.existence = 0.9;
  car.position = {x, 0, 0};
  car.length = 4.5, car.width = 1.8;
  car.speed = speed;
  car.velocity = {speed, 0};
  return car;
}

TEST(SafetyMonitor, AnObstacleNearerThanTheStoppingDistanceCallsForAStop) {
  SafetyMonitor monitor(gridOfBox(), {});
  for (const double t : {0.0, 0.1, 0.2}) monitor.add(BoxScan(t, 20).frame, BoxScan(t, 20).returns);
  const PathAhead path = monitor.pathAhead(egoDriving(0.2, 10));
  ASSERT_TRUE(path.known);
  EXPECT_TRUE(path.free.blocked);
  EXPECT_NEAR(path.free.distance, 20, 0.3);
  const FreePath fast = monitor.advise(path, sceneDriving(0.2, 12));  // 25 m
  EXPECT_TRUE(fast.stop);
  EXPECT_EQ(fast.owner, 0u);
  EXPECT_FALSE(monitor.advise(path, sceneDriving(0.2, 9)).stop);  // 15.6 m
}

TEST(SafetyMonitor, ManyDoubtedReturnsOfOneScanAreNoObstacle) {
  for (const float trust : {0.4F, 0.6F}) {
    BoxScan scan(0, 60);
    scan.frame.causes.weather = 1;
    scan.addCloud(trust);
    scan.solid(0.1F);
    SafetyMonitor monitor(gridOfBox(), {});
    monitor.add(scan.frame, scan.returns);
    const FreeDistance free = monitor.pathAhead(egoDriving(0, 10)).free;
    const bool by_cloud = free.blocked && free.distance < 20;
    EXPECT_EQ(by_cloud, trust == 0.6F);
  }
}

TEST(SafetyMonitor, InACloudAStopTakesTwoScenesInARow) {
  for (const float trust : {0.1F, 1.F}) {
    SafetyMonitor monitor(gridOfBox(), {});
    const auto stops = [&](double t, double x) {
      BoxScan scan(t, x);
      scan.frame.causes.weather = 1;
      if (trust < 1) scan.addCloud(trust);
      scan.solid(0.1F);
      monitor.add(scan.frame, scan.returns);
      const PathAhead path = monitor.pathAhead(egoDriving(t, 12));
      EXPECT_EQ(path.in_cloud, path.free.blocked && trust < 1);
      return monitor.advise(path, sceneDriving(t, 12)).stop;  // within 25 m
    };
    EXPECT_EQ(stops(0, 20), trust == 1);
    EXPECT_TRUE(stops(0.1, 20));
  }
}

TEST(SafetyMonitor, InACloudASurfaceOfManyReturnsCallsForAStopAtOnce) {
  for (const int solid : {15, 25}) {
    BoxScan scan(0, 20);
    scan.frame.causes.weather = 1;
    scan.addCloud(0.1F);
    scan.solid(0.1F);
    std::fill_n(scan.returns.solid.begin(), solid, 0.8F);  // of the 77 returns of the box
    SafetyMonitor monitor(gridOfBox(), {});
    monitor.add(scan.frame, scan.returns);
    const PathAhead path = monitor.pathAhead(egoDriving(0, 12));
    ASSERT_TRUE(path.free.blocked);
    EXPECT_EQ(monitor.advise(path, sceneDriving(0, 12)).stop, solid == 25);
  }
}

TEST(SafetyMonitor, AnOlderSceneIsNotTheOneBefore) {
  SafetyMonitor monitor(gridOfBox(), {});
  const auto stops = [&](double t) {
    BoxScan scan(t, 20);
    scan.frame.causes.weather = 1;
    scan.addCloud(0.1F);
    scan.solid(0.1F);
    monitor.add(scan.frame, scan.returns);
    return monitor.advise(monitor.pathAhead(egoDriving(t, 12)), sceneDriving(t, 12)).stop;
  };
  EXPECT_FALSE(stops(0));
  EXPECT_FALSE(stops(0.6));
  EXPECT_TRUE(stops(0.7));
}

TEST(SafetyMonitor, AnAdviceSaysWhatItIsFor) {
  SafetyMonitor monitor(gridOfBox(), {});
  const auto adviceAt = [&](double t, std::vector<SceneObject> objects) {
    monitor.add(BoxScan(t, 20).frame, BoxScan(t, 20).returns);
    Scene scene = sceneDriving(t, 12);
    scene.objects = std::move(objects);
    return monitor.advise(monitor.pathAhead(scene.ego), scene);
  };
  const FreePath first = adviceAt(0, {});
  EXPECT_TRUE(first.stop);
  EXPECT_EQ(first.cause, FreePath::Cause::kReturns) << "no cell is occupied by one scan";
  EXPECT_EQ(first.returns, 77u);
  EXPECT_EQ(first.overruled, 0u);
  EXPECT_EQ(adviceAt(0.1, {carAt(22.25, 0)}).cause, FreePath::Cause::kObject);
  EXPECT_EQ(adviceAt(0.2, {}).cause, FreePath::Cause::kGrid);
}

TEST(SafetyMonitor, AVehicleThatMovesOnEveryScanIsSeenAllTheSame) {
  SafetyMonitor monitor(gridOfBox(), {});
  for (int i = 0; i < 4; ++i)
    monitor.add(BoxScan(0.1 * i, 15 + 1.4 * i).frame, BoxScan(0.1 * i, 15 + 1.4 * i).returns);
  const PathAhead path = monitor.pathAhead(egoDriving(0.3, 10));
  EXPECT_TRUE(path.free.blocked);
  EXPECT_NEAR(path.free.distance, 19.2, 0.3);
}

TEST(SafetyMonitor, ACarThatDrivesAheadAsFastIsNoStopAndIsNamed) {
  SafetyMonitor monitor(gridOfBox(), {});
  for (const double t : {0.0, 0.1}) monitor.add(BoxScan(t, 20).frame, BoxScan(t, 20).returns);
  Scene scene = sceneDriving(0.1, 14);
  scene.objects = {carAt(22.25, 14)};
  const PathAhead path = monitor.pathAhead(scene.ego);
  const FreePath moving = monitor.advise(path, scene);
  EXPECT_EQ(moving.owner, 4u);
  EXPECT_FALSE(moving.stop);
  scene.objects = {carAt(22.25, 0)};
  EXPECT_TRUE(monitor.advise(path, scene).stop);
}

TEST(SafetyMonitor, WithoutAScanForHalfASecondNothingIsKnown) {
  SafetyMonitor monitor(gridOfBox(), {});
  EXPECT_FALSE(monitor.pathAhead(egoDriving(0, 10)).known);
  monitor.add(BoxScan(0, 20).frame, BoxScan(0, 20).returns);
  EXPECT_TRUE(monitor.pathAhead(egoDriving(0.4, 10)).known);
  EXPECT_FALSE(monitor.pathAhead(egoDriving(0.6, 10)).known);
  monitor.restart();
  EXPECT_FALSE(monitor.pathAhead(egoDriving(0.1, 10)).known);
}

// The way that the vehicle drives.

TEST(SafetyMonitor, AVehicleThatReversesStopsForWhatStandsBehind) {
  SafetyMonitor monitor(gridOfBox(), {});
  EgoState ego = egoDriving(0, -2);
  BoxScan scan(0, -5);
  scan.frame.ego = ego;
  scan.returns.vehicle_rear = 2;
  monitor.add(scan.frame, scan.returns);
  const PathAhead path = monitor.pathAhead(ego);
  EXPECT_TRUE(path.corridor.backward);
  ASSERT_TRUE(path.free.blocked) << "in the first scan";
  EXPECT_NEAR(path.free.distance, 5, 0.3);
  EXPECT_FALSE(monitor.pathAhead(egoDriving(0, 2)).free.blocked);
}

TEST(SafetyMonitor, WhatHangsHigherThanTheVehicleDoesNotBlock) {
  for (const double lower : {2.2, 1.4}) {
    SafetyMonitor monitor(gridOfBox(), {});
    BoxScan scan(0, 20);
    for (std::size_t i = 0; i < scan.returns.size(); ++i) {
      if (scan.returns.z[i] < 0.3F) continue;
      scan.returns.z[i] += static_cast<float>(lower) - 0.4F;  // the box's lower edge
      scan.returns.height[i] = scan.returns.z[i];
    }
    monitor.add(scan.frame, scan.returns);
    EXPECT_EQ(monitor.pathAhead(egoDriving(0, 10)).free.blocked, lower < 2) << lower;
  }
  StopParams bus;
  bus.vehicle.height = 3;
  SafetyMonitor monitor(gridOfBox(), bus);
  BoxScan scan(0, 20);
  for (std::size_t i = 0; i < scan.returns.size(); ++i)
    if (scan.returns.z[i] > 0.3F) scan.returns.height[i] = 2.5F;
  monitor.add(scan.frame, scan.returns);
  EXPECT_TRUE(monitor.pathAhead(egoDriving(0, 10)).free.blocked) << "a bus is higher";
}

TEST(SafetyMonitor, TheFreeDistanceIsNoLongerThanWhatWasSeen) {
  SafetyMonitor monitor(gridOfBox(), {});
  BoxScan scan(0, 12);  // nothing but a box beside the way, and the road before it
  for (std::size_t i = 0; i < scan.returns.size(); ++i)
    if (scan.returns.z[i] > 0.3F) scan.returns.y[i] += 5;
  monitor.add(scan.frame, scan.returns);
  const PathAhead path = monitor.pathAhead(egoDriving(0, 10));
  ASSERT_FALSE(path.free.blocked);
  const FreePath advice = monitor.advise(path, sceneDriving(0, 10));
  EXPECT_LT(advice.distance, 13);
  EXPECT_LE(advice.distance, advice.seen);
  EXPECT_FALSE(advice.stop);
  EXPECT_TRUE(advice.too_fast) << "10 m/s need 18.5 m";
  EXPECT_LT(stoppingDistance(advice.safe_speed, 0, {}), 12);
  EXPECT_FALSE(monitor.advise(path, sceneDriving(0, advice.safe_speed - 0.1)).too_fast);
}

}  // namespace
}  // namespace perception
