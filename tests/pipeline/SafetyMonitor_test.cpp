#include "libperception/pipeline/SafetyMonitor.h"

#include <gtest/gtest.h>

#include "libperception/core/Angle.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

/// A scan of a box one meter wide and high at `x` [m] ahead, and of the road before it.
struct Scan {
  SensorFrame frame;
  PlacedReturns returns;

  Scan(double t, double x, float trust = 1) {
    frame.stamp = kStart + t;
    frame.ego.stamp = frame.stamp;
    frame.T_ego_sensor = makePose(0, 0, 1.7, 0);
    frame.data = LidarCloud{};
    for (double y = -0.5; y <= 0.5; y += 0.1)
      for (double z = 0.4; z <= 1; z += 0.1) add(x, y, z, trust);
    for (double road = 4; road < x; road += 0.2) add(road, 0, 0, 1);
    returns.height_min = 0.3, returns.height_max = 3;
    returns.vehicle_front = 2;
  }
  /// A cloud of drops over the road before the box, one return each 0.1 m.
  void addCloud(float trust) {
    for (double x = 10; x < 19; x += 0.1)
      for (const double y : {-.4, 0., .4}) add(x, y, 1, trust);
  }

 private:
  void add(double px, double py, double pz, float trusted) {
    auto& cloud = std::get<LidarCloud>(frame.data);
    returns.source.push_back(static_cast<std::uint32_t>(cloud.x.size()));
    for (auto* v : {&returns.x, &cloud.x}) v->push_back(static_cast<float>(px));
    for (auto* v : {&returns.y, &cloud.y}) v->push_back(static_cast<float>(py));
    for (auto* v : {&returns.z, &cloud.z}) v->push_back(static_cast<float>(pz));
    returns.height.push_back(static_cast<float>(pz));
    cloud.trust.push_back(trusted);
  }
};

EgoState egoAt(double t, double speed) {
  EgoState ego;
  ego.stamp = kStart + t;
  ego.velocity = {speed, 0};
  return ego;
}

Scene sceneAt(double t, double speed) {
  Scene scene;
  scene.stamp = kStart + t;
  scene.ego = egoAt(t, speed);
  return scene;
}

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

GridParams smallGrid() {
  GridParams grid;
  grid.size = 60;
  return grid;
}

TEST(SafetyMonitor, AnObstacleNearerThanTheStoppingDistanceCallsForAStop) {
  SafetyMonitor monitor(smallGrid(), {});
  for (const double t : {0.0, 0.1, 0.2}) monitor.add(Scan(t, 20).frame, Scan(t, 20).returns);
  const PathAhead path = monitor.pathAhead(egoAt(0.2, 10));
  ASSERT_TRUE(path.known);
  EXPECT_TRUE(path.free.blocked);
  EXPECT_NEAR(path.free.distance, 20, 0.3);
  const FreePath fast = monitor.advise(path, sceneAt(0.2, 12));  // 25 m
  EXPECT_TRUE(fast.stop);
  EXPECT_EQ(fast.owner, 0u);
  EXPECT_FALSE(monitor.advise(path, sceneAt(0.2, 9)).stop);  // 15.6 m
}

TEST(SafetyMonitor, WhatIsDoubtedBlocksNothing) {
  SafetyMonitor monitor(smallGrid(), {});
  for (const double t : {0.0, 0.1, 0.2})
    monitor.add(Scan(t, 20, 0.01F).frame, Scan(t, 20, 0.01F).returns);
  EXPECT_FALSE(monitor.pathAhead(egoAt(0.2, 10)).free.blocked);
}

TEST(SafetyMonitor, AClusterThatIsAPhantomBlocksNothing) {
  for (const float phantom : {0.99F, 0.01F}) {
    SafetyMonitor monitor(smallGrid(), {});
    for (const double t : {0.0, 0.1, 0.2}) {
      Scan scan(t, 20);
      scan.returns.phantom.assign(scan.returns.size(), phantom);
      monitor.add(scan.frame, scan.returns);
    }
    EXPECT_EQ(monitor.pathAhead(egoAt(0.2, 10)).free.blocked, phantom < 0.5F);
  }
}

TEST(SafetyMonitor, OneScanBlocksOnlyByItsClusters) {
  Scan scan(0, 20);
  scan.returns.phantom.assign(scan.returns.size(), PlacedReturns::kNoCluster);
  SafetyMonitor monitor(smallGrid(), {});
  monitor.add(scan.frame, scan.returns);
  EXPECT_FALSE(monitor.pathAhead(egoAt(0, 10)).free.blocked);
  scan.returns.phantom.assign(scan.returns.size(), 0);
  SafetyMonitor told(smallGrid(), {});
  told.add(scan.frame, scan.returns);
  EXPECT_TRUE(told.pathAhead(egoAt(0, 10)).free.blocked);
}

TEST(SafetyMonitor, ManyDoubtedReturnsOfOneScanAreNoObstacle) {
  for (const float trust : {0.4F, 0.6F}) {
    Scan scan(0, 60);
    scan.addCloud(trust);
    SafetyMonitor monitor(smallGrid(), {});
    monitor.add(scan.frame, scan.returns);
    const FreeDistance free = monitor.pathAhead(egoAt(0, 10)).free;
    const bool by_cloud = free.blocked && free.distance < 20;
    EXPECT_EQ(by_cloud, trust == 0.6F);
  }
}

TEST(SafetyMonitor, InACloudAStopTakesTwoScenesInARow) {
  for (const float trust : {0.1F, 1.F}) {
    SafetyMonitor monitor(smallGrid(), {});
    const auto stops = [&](double t, double x) {
      Scan scan(t, x);
      if (trust < 1) scan.addCloud(trust);
      monitor.add(scan.frame, scan.returns);
      const PathAhead path = monitor.pathAhead(egoAt(t, 12));
      EXPECT_EQ(path.in_cloud, path.free.blocked && trust < 1);
      return monitor.advise(path, sceneAt(t, 12)).stop;  // within 25 m
    };
    EXPECT_EQ(stops(0, 20), trust == 1);
    EXPECT_TRUE(stops(0.1, 20));
  }
}

TEST(SafetyMonitor, AnOlderSceneIsNotTheOneBefore) {
  SafetyMonitor monitor(smallGrid(), {});
  const auto stops = [&](double t) {
    Scan scan(t, 20);
    scan.addCloud(0.1F);
    monitor.add(scan.frame, scan.returns);
    return monitor.advise(monitor.pathAhead(egoAt(t, 12)), sceneAt(t, 12)).stop;
  };
  EXPECT_FALSE(stops(0));
  EXPECT_FALSE(stops(0.6));
  EXPECT_TRUE(stops(0.7));
}

TEST(SafetyMonitor, AVehicleThatMovesOnEveryScanIsSeenAllTheSame) {
  SafetyMonitor monitor(smallGrid(), {});
  for (int i = 0; i < 4; ++i)
    monitor.add(Scan(0.1 * i, 15 + 1.4 * i).frame, Scan(0.1 * i, 15 + 1.4 * i).returns);
  const PathAhead path = monitor.pathAhead(egoAt(0.3, 10));
  EXPECT_TRUE(path.free.blocked);
  EXPECT_NEAR(path.free.distance, 19.2, 0.3);
}

TEST(SafetyMonitor, ACarThatDrivesAheadAsFastIsNoStopAndIsNamed) {
  SafetyMonitor monitor(smallGrid(), {});
  for (const double t : {0.0, 0.1}) monitor.add(Scan(t, 20).frame, Scan(t, 20).returns);
  Scene scene = sceneAt(0.1, 14);
  scene.objects = {carAt(22.25, 14)};
  const PathAhead path = monitor.pathAhead(scene.ego);
  const FreePath moving = monitor.advise(path, scene);
  EXPECT_EQ(moving.owner, 4u);
  EXPECT_FALSE(moving.stop);
  scene.objects = {carAt(22.25, 0)};
  EXPECT_TRUE(monitor.advise(path, scene).stop);
}

TEST(SafetyMonitor, WithoutAScanForHalfASecondNothingIsKnown) {
  SafetyMonitor monitor(smallGrid(), {});
  EXPECT_FALSE(monitor.pathAhead(egoAt(0, 10)).known);
  monitor.add(Scan(0, 20).frame, Scan(0, 20).returns);
  EXPECT_TRUE(monitor.pathAhead(egoAt(0.4, 10)).known);
  EXPECT_FALSE(monitor.pathAhead(egoAt(0.6, 10)).known);
  monitor.restart();
  EXPECT_FALSE(monitor.pathAhead(egoAt(0.1, 10)).known);
}

}  // namespace
}  // namespace perception
