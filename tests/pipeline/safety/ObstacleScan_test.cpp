#include "libperception/pipeline/safety/ObstacleScan.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/pipeline/safety/BoxAhead.h"

namespace perception {
namespace {

using namespace test;

// Nothing learned from shapes, and no trust, takes an obstacle out of the grid by itself.

TEST(ObstacleScan, InClearAirEveryReturnCountsWhateverItsTrustAndShape) {
  for (const float trust : {0.01F, 1.F}) {
    for (const float phantom : {0.99F, 0.01F, PlacedReturns::kNoCluster}) {
      const PathAhead path = afterScans(1, 0, [&](BoxScan& scan) {
        scan.trustBox(trust);
        scan.returns.phantom.assign(scan.returns.size(), phantom);
      });
      EXPECT_TRUE(path.free.blocked) << "in the first scan; trust " << trust << ", " << phantom;
      EXPECT_FALSE(path.in_cloud);
    }
  }
}

TEST(ObstacleScan, TheDoubtIsAsStrongAsItsCause) {
  for (const double weather : {0.0, 0.1, 0.6, 1.0}) {
    BoxScan scan(0, 20);
    scan.frame.causes.weather = weather;
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    const ObstacleScan obstacles = obstacleScanOf(scan.frame, scan.returns);
    for (const float weight : obstacles.scan.weights)
      EXPECT_NEAR(static_cast<double>(weight), 1 - std::min(weather, 0.99), 1e-6);
    for (const char doubted : obstacles.doubted) EXPECT_TRUE(doubted);
  }
}

TEST(ObstacleScan, InWeatherADoubtedCloudBlocksNothing) {
  const auto cloud = [](BoxScan& scan) {
    scan.trustBox(0.01F);
    scan.solid(0.1F);
  };
  EXPECT_FALSE(afterScans(3, 1, cloud).free.blocked);
  EXPECT_TRUE(afterScans(3, 0, cloud).free.blocked);
}

TEST(ObstacleScan, InWeatherASurfaceCountsInTheSecondScan) {
  const auto surface = [&](BoxScan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    scan.solid(0.5F);
  };
  EXPECT_FALSE(afterScans(1, 1, surface).free.blocked);
  const PathAhead path = afterScans(2, 1, surface);
  EXPECT_TRUE(path.free.blocked);
  EXPECT_GT(path.overruled, 10u);
}

TEST(ObstacleScan, AmongFlakesAnEdgeCountsInTheSecondScanAndAClumpDoesNot) {
  for (const float share : {0.5F, 0.6F}) {
    const PathAhead path = afterScans(3, 1, [&](BoxScan& scan) {
      scan.returns.phantom.assign(scan.returns.size(), 0.99F);
      scan.solid(share);
      for (float& x : scan.returns.x) x -= 12;
    });
    EXPECT_EQ(path.free.blocked, share == 0.6F) << "dense flakes hit a place again by chance";
  }
}

TEST(ObstacleScan, InWeatherWhatIsSolidAsAWallCountsAtOnce) {
  const auto wall = [](BoxScan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    scan.solid(0.9F);
  };
  EXPECT_TRUE(afterScans(1, 1, wall).free.blocked);
}

TEST(ObstacleScan, WhatMovesOnFromScanToScanDoesNotPersist) {
  int k = 0;
  const auto flurry = [&](BoxScan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), 0.99F);
    scan.solid(0.5F);
    for (float& x : scan.returns.x) x += static_cast<float>(2 * k);
    ++k;
  };
  EXPECT_FALSE(afterScans(3, 1, flurry).free.blocked);
}

TEST(ObstacleScan, AMirrorImageIsNoObstacleInAnyAir) {
  EXPECT_FALSE(afterScans(3, 0, [](BoxScan& scan) { scan.trustBox(0); }).free.blocked);
}

TEST(ObstacleScan, WhatTheSensorCallsRainIsDoubtedInAnyAir) {
  const auto rain = [](BoxScan& scan) {
    scan.trustBox(0.01F);
    auto& cloud = std::get<LidarCloud>(scan.frame.data);
    cloud.label.assign(cloud.size(), static_cast<std::uint8_t>(PointLabel::kRain));
  };
  EXPECT_FALSE(afterScans(3, 0, rain).free.blocked);
}

TEST(ObstacleScan, BehindAVehicleItsSprayIsDoubtedAndNowhereElse) {
  for (const double side : {0., 8.}) {
    auto wakes = std::make_shared<WakeMap>();
    VehicleFootprint car;  // was at the box a second ago
    car.center = {20, side}, car.speed = 10, car.half_length = 2, car.half_width = 1;
    car.stamp = kStart + -0.9;
    wakes->add(car);
    const PathAhead path = afterScans(1, 0, [&](BoxScan& scan) {
      scan.frame.causes.wakes = wakes;
      scan.returns.phantom.assign(scan.returns.size(), 0.99F);
      scan.solid(0.1F);
    });
    EXPECT_EQ(path.free.blocked, side > 0);
  }
}

TEST(ObstacleScan, InAWakeOnlyWhatIsSolidTwiceEndsTheDoubt) {
  auto wakes = std::make_shared<WakeMap>();
  VehicleFootprint car;  // was at the box a second ago
  car.center = {20, 0}, car.speed = 10, car.half_length = 2, car.half_width = 1;
  car.stamp = kStart + -0.9;
  wakes->add(car);
  const auto blocked = [&](int scans, float solid) {
    return afterScans(scans, 0,
                      [&](BoxScan& scan) {
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

TEST(ObstacleScan, InACloudBesideTheVehicleOnlyWhatIsSolidTwiceEndsTheDoubt) {
  auto clouds = std::make_shared<AirClouds>();
  clouds->probability.fill(0.9);
  const auto blocked = [&](int scans, float solid, bool cloud) {
    return afterScans(scans, 0,
                      [&](BoxScan& scan) {
                        for (float& x : scan.returns.x) x -= 12;
                        if (cloud) scan.frame.causes.clouds = clouds;
                        scan.returns.phantom.assign(scan.returns.size(), 0.99F);
                        scan.solid(solid);
                      })
        .free.blocked;
  };
  EXPECT_TRUE(blocked(1, 0.1F, false)) << "in clear air every return counts";
  EXPECT_FALSE(blocked(3, 0.1F, true));
  EXPECT_FALSE(blocked(1, 1, true));
  EXPECT_TRUE(blocked(2, 1, true));
}

TEST(ObstacleScan, InWeatherOneScanBlocksOnlyByItsClusters) {
  const auto loose = [](BoxScan& scan) {
    scan.returns.phantom.assign(scan.returns.size(), PlacedReturns::kNoCluster);
    scan.solid(0.1F);
  };
  EXPECT_FALSE(afterScans(1, 1, loose).free.blocked);
  EXPECT_TRUE(afterScans(1, 0, loose).free.blocked);
  EXPECT_TRUE(afterScans(1, 1, [](BoxScan& scan) {
                scan.returns.phantom.assign(scan.returns.size(), 0);
              }).free.blocked);
}

}  // namespace
}  // namespace perception
