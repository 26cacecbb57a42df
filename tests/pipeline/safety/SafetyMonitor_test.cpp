#include "libperception/pipeline/safety/SafetyMonitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "libperception/core/math/Angle.h"
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
  /// Trust of the box's returns.
  void trustBox(float trust) {
    auto& cloud = std::get<LidarCloud>(frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud.z[i] > 0) cloud.trust[i] = trust;
  }
  /// Share of the directions about every return that end there.
  void solid(float share) { returns.solid.assign(returns.size(), share); }
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

/// Scans 0.1 s apart as they are, in air that is not clear with that probability.
PathAhead after(int scans, double weather, const std::function<void(Scan&)>& change,
                double speed = 10) {
  SafetyMonitor monitor(smallGrid(), {});
  PathAhead path;
  for (int k = 0; k < scans; ++k) {
    Scan scan(0.1 * k, 20);
    scan.frame.causes.weather = weather;
    change(scan);
    monitor.add(scan.frame, scan.returns);
    path = monitor.pathAhead(egoAt(0.1 * k, speed));
  }
  return path;
}

// Nothing learned from shapes, and no trust, takes an obstacle out of the grid by itself.

TEST(SafetyMonitor, InClearAirEveryReturnCountsWhateverItsTrustAndShape) {
  for (const float trust : {0.01F, 1.F}) {
    for (const float phantom : {0.99F, 0.01F, PlacedReturns::kNoCluster}) {
      const PathAhead path = after(1, 0, [&](Scan& scan) {
        scan.trustBox(trust);
        scan.returns.phantom.assign(scan.returns.size(), phantom);
      });
      EXPECT_TRUE(path.free.blocked) << "in the first scan; trust " << trust << ", " << phantom;
      EXPECT_FALSE(path.in_cloud);
    }
  }
}

TEST(SafetyMonitor, TheDoubtIsAsStrongAsItsCause) {
  for (const double weather : {0.0, 0.1, 0.6, 1.0}) {
    Scan scan(0, 20);
    scan.frame.causes.weather = weather;
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    const ObstacleScan obstacles = obstacleScanOf(scan.frame, scan.returns);
    for (const float weight : obstacles.scan.weights)
      EXPECT_NEAR(static_cast<double>(weight), 1 - std::min(weather, 0.99), 1e-6);
    for (const char doubted : obstacles.doubted) EXPECT_TRUE(doubted);
  }
}

TEST(SafetyMonitor, InWeatherADoubtedCloudBlocksNothing) {
  const auto cloud = [](Scan& scan) {
    scan.trustBox(0.01F);
    scan.solid(0.1F);
  };
  EXPECT_FALSE(after(3, 1, cloud).free.blocked);
  EXPECT_TRUE(after(3, 0, cloud).free.blocked);
}

TEST(SafetyMonitor, InWeatherASurfaceCountsInTheSecondScan) {
  const auto surface = [&](Scan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    scan.solid(0.5F);
  };
  EXPECT_FALSE(after(1, 1, surface).free.blocked);
  const PathAhead path = after(2, 1, surface);
  EXPECT_TRUE(path.free.blocked);
  EXPECT_GT(path.overruled, 10u);
}

TEST(SafetyMonitor, AmongFlakesAnEdgeCountsInTheSecondScanAndAClumpDoesNot) {
  for (const float share : {0.5F, 0.6F}) {
    const PathAhead path = after(3, 1, [&](Scan& scan) {
      scan.returns.phantom.assign(scan.returns.size(), 0.99F);
      scan.solid(share);
      for (float& x : scan.returns.x) x -= 12;
    });
    EXPECT_EQ(path.free.blocked, share == 0.6F) << "dense flakes hit a place again by chance";
  }
}

TEST(SafetyMonitor, InWeatherWhatIsSolidAsAWallCountsAtOnce) {
  const auto wall = [](Scan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    scan.solid(0.9F);
  };
  EXPECT_TRUE(after(1, 1, wall).free.blocked);
}

TEST(SafetyMonitor, WhatMovesOnFromScanToScanDoesNotPersist) {
  int k = 0;
  const auto flurry = [&](Scan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    scan.solid(0.5F);
    for (float& x : scan.returns.x) x += static_cast<float>(2 * k);
    ++k;
  };
  EXPECT_FALSE(after(3, 1, flurry).free.blocked);
}

TEST(SafetyMonitor, AMirrorImageIsNoObstacleInAnyAir) {
  EXPECT_FALSE(after(3, 0, [](Scan& scan) { scan.trustBox(0); }).free.blocked);
}

TEST(SafetyMonitor, WhatTheSensorCallsRainIsDoubtedInAnyAir) {
  const auto rain = [](Scan& scan) {
    scan.trustBox(0.01F);
    auto& cloud = std::get<LidarCloud>(scan.frame.data);
    cloud.label.assign(cloud.size(), static_cast<std::uint8_t>(PointLabel::kRain));
  };
  EXPECT_FALSE(after(3, 0, rain).free.blocked);
}

TEST(SafetyMonitor, BehindAVehicleItsSprayIsDoubtedAndNowhereElse) {
  for (const double side : {0., 8.}) {
    auto wakes = std::make_shared<WakeMap>();
    VehicleFootprint car;  // was at the box a second ago
    car.center = {20, side}, car.speed = 10, car.half_length = 2, car.half_width = 1;
    car.stamp = kStart + -0.9;
    wakes->add(car);
    const PathAhead path = after(1, 0, [&](Scan& scan) {
      scan.frame.causes.wakes = wakes;
      scan.returns.phantom.assign(scan.returns.size(), 0.99F);
      scan.solid(0.1F);
    });
    EXPECT_EQ(path.free.blocked, side > 0);
  }
}

TEST(SafetyMonitor, InAWakeOnlyWhatIsSolidTwiceEndsTheDoubt) {
  auto wakes = std::make_shared<WakeMap>();
  VehicleFootprint car;  // was at the box a second ago
  car.center = {20, 0}, car.speed = 10, car.half_length = 2, car.half_width = 1;
  car.stamp = kStart + -0.9;
  wakes->add(car);
  const auto blocked = [&](int scans, float solid) {
    return after(scans, 0,
                 [&](Scan& scan) {
                   scan.frame.causes.wakes = wakes;
                   scan.returns.phantom.assign(scan.returns.size(), 0.99F);
                   scan.solid(solid);
                 })
        .free.blocked;
  };
  EXPECT_FALSE(blocked(1, 1)) << "the cloud close behind a vehicle is as dense";
  EXPECT_TRUE(blocked(2, 1));
  EXPECT_FALSE(blocked(2, 0.8F));
}

TEST(SafetyMonitor, InWeatherOneScanBlocksOnlyByItsClusters) {
  const auto loose = [](Scan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), PlacedReturns::kNoCluster);
    scan.solid(0.1F);
  };
  EXPECT_FALSE(after(1, 1, loose).free.blocked);
  EXPECT_TRUE(after(1, 0, loose).free.blocked);
  EXPECT_TRUE(after(1, 1, [](Scan& scan) {
                scan.returns.phantom.assign(scan.returns.size(), 0);
              }).free.blocked);
}

TEST(SafetyMonitor, ManyDoubtedReturnsOfOneScanAreNoObstacle) {
  for (const float trust : {0.4F, 0.6F}) {
    Scan scan(0, 60);
    scan.frame.causes.weather = 1;
    scan.addCloud(trust);
    scan.solid(0.1F);
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
      scan.frame.causes.weather = 1;
      if (trust < 1) scan.addCloud(trust);
      scan.solid(0.1F);
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
    scan.frame.causes.weather = 1;
    scan.addCloud(0.1F);
    scan.solid(0.1F);
    monitor.add(scan.frame, scan.returns);
    return monitor.advise(monitor.pathAhead(egoAt(t, 12)), sceneAt(t, 12)).stop;
  };
  EXPECT_FALSE(stops(0));
  EXPECT_FALSE(stops(0.6));
  EXPECT_TRUE(stops(0.7));
}

TEST(SafetyMonitor, AnAdviceSaysWhatItIsFor) {
  SafetyMonitor monitor(smallGrid(), {});
  const auto adviceAt = [&](double t, std::vector<SceneObject> objects) {
    monitor.add(Scan(t, 20).frame, Scan(t, 20).returns);
    Scene scene = sceneAt(t, 12);
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

// The way that the vehicle drives.

TEST(SafetyMonitor, AVehicleThatReversesStopsForWhatStandsBehind) {
  SafetyMonitor monitor(smallGrid(), {});
  EgoState ego = egoAt(0, -2);
  Scan scan(0, -5);
  scan.frame.ego = ego;
  scan.returns.vehicle_rear = 2;
  monitor.add(scan.frame, scan.returns);
  const PathAhead path = monitor.pathAhead(ego);
  EXPECT_TRUE(path.corridor.backward);
  ASSERT_TRUE(path.free.blocked) << "in the first scan";
  EXPECT_NEAR(path.free.distance, 5, 0.3);
  EXPECT_FALSE(monitor.pathAhead(egoAt(0, 2)).free.blocked);
}

TEST(SafetyMonitor, WhatHangsHigherThanTheVehicleDoesNotBlock) {
  for (const double lower : {2.2, 1.4}) {
    SafetyMonitor monitor(smallGrid(), {});
    Scan scan(0, 20);
    for (std::size_t i = 0; i < scan.returns.size(); ++i) {
      if (scan.returns.z[i] < 0.3F) continue;
      scan.returns.z[i] += static_cast<float>(lower) - 0.4F;  // the box's lower edge
      scan.returns.height[i] = scan.returns.z[i];
    }
    monitor.add(scan.frame, scan.returns);
    EXPECT_EQ(monitor.pathAhead(egoAt(0, 10)).free.blocked, lower < 2) << lower;
  }
  StopParams bus;
  bus.vehicle.height = 3;
  SafetyMonitor monitor(smallGrid(), bus);
  Scan scan(0, 20);
  for (std::size_t i = 0; i < scan.returns.size(); ++i)
    if (scan.returns.z[i] > 0.3F) scan.returns.height[i] = 2.5F;
  monitor.add(scan.frame, scan.returns);
  EXPECT_TRUE(monitor.pathAhead(egoAt(0, 10)).free.blocked) << "a bus is higher";
}

TEST(SafetyMonitor, TheFreeDistanceIsNoLongerThanWhatWasSeen) {
  SafetyMonitor monitor(smallGrid(), {});
  Scan scan(0, 12);  // nothing but a box beside the way, and the road before it
  for (std::size_t i = 0; i < scan.returns.size(); ++i)
    if (scan.returns.z[i] > 0.3F) scan.returns.y[i] += 5;
  monitor.add(scan.frame, scan.returns);
  const PathAhead path = monitor.pathAhead(egoAt(0, 10));
  ASSERT_FALSE(path.free.blocked);
  const FreePath advice = monitor.advise(path, sceneAt(0, 10));
  EXPECT_LT(advice.distance, 13);
  EXPECT_LE(advice.distance, advice.seen);
  EXPECT_FALSE(advice.stop);
  EXPECT_TRUE(advice.too_fast) << "10 m/s need 18.5 m";
  EXPECT_LT(stoppingDistance(advice.safe_speed, 0, {}), 12);
  EXPECT_FALSE(monitor.advise(path, sceneAt(0, advice.safe_speed - 0.1)).too_fast);
}

}  // namespace
}  // namespace perception
