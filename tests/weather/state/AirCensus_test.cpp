#include "libperception/weather/state/AirCensus.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/weather/trust/PointTrust.h"

namespace perception {
namespace {

constexpr double kHeight = 1.8;  // [m] of the lidar

/// Flat ground and a wall all around at 25 m; a beam in `share` within a direction of `from` to
/// `to` [deg] meets a flake at 3 m.
SensorFrame scan(double share, double from = -180, double to = 180) {
  SensorFrame frame;
  frame.sensor = "LIDAR";
  frame.T_ego_sensor = makePose(0, 0, kHeight, 0);
  frame.ground.measured = true;
  LidarCloud cloud;
  Rng random({7, 0, 0, 0});
  for (int step = 0; step < 1800; ++step) {
    for (int beam = 0; beam < 64; ++beam) {
      const double degrees = step * 0.2 - 179.95;
      const double a = radians(degrees), e = radians(-24.3 + 0.42 * beam);
      const Vector3 d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      const double ground = d.z() < 0 ? -kHeight / d.z() : 1e9;
      double range = std::min(ground, 25 / std::cos(e));
      if (random.uniform() < share && degrees > from && degrees < to && d.z() > -0.3) range = 3;
      const Vector3 p = range * d;
      cloud.x.push_back(static_cast<float>(p.x())), cloud.y.push_back(static_cast<float>(p.y()));
      cloud.z.push_back(static_cast<float>(p.z()));
    }
  }
  frame.data = std::move(cloud);
  return frame;
}

AirCensus censusOf(SensorFrame frame) {
  PointTrust trust{TrustParams()};
  trust.apply(frame);
  return trust.census(frame);
}

double loneAt3m(const AirCensus::Sector& sector) { return sector.lone[1] / sector.returns; }

TEST(AirCensus, InClearAirNothingIsInFreeAir) {
  const AirCensus census = censusOf(scan(0));
  for (const auto& sector : census.sectors) {
    EXPECT_NEAR(sector.returns, 1800 * 64 / 24.0, 160);
    for (const double lone : sector.lone) EXPECT_EQ(lone, 0);
  }
}

TEST(AirCensus, FlakesAreCountedByDirectionAndShell) {
  const AirCensus census = censusOf(scan(0.01, 0, 90));
  // Azimuth 0 lies between sectors 11 and 12; 90 deg is six sectors on.
  EXPECT_NEAR(loneAt3m(census.sectors[13]), 0.01 * 0.85, 0.003);
  EXPECT_NEAR(loneAt3m(census.sectors[16]), 0.01 * 0.85, 0.003);
  EXPECT_EQ(loneAt3m(census.sectors[5]), 0);
  EXPECT_EQ(census.sectors[13].lone[0], 0);
  EXPECT_EQ(census.sectors[13].lone[3], 0);
}

TEST(AirCensus, LevelFlakesAreCountedWithTheirBrightnessAndStopNoBeam) {
  SensorFrame frame = scan(0.2, 0, 90);
  auto& cloud = std::get<LidarCloud>(frame.data);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    // What returns from 3 m comes from 2 m, with 10 % of the light.
    const float range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    const bool flake = std::abs(range - 3) < 1e-3F;
    if (flake)
      for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) (*axis)[i] *= 2.0F / 3;
    cloud.intensity.push_back(flake ? 0.1F : 0.3F);
  }
  const AirCensus::Sector sector = censusOf(std::move(frame)).sectors[14];
  ASSERT_GT(sector.level_lone[0], 20);
  EXPECT_NEAR(sector.brightness / sector.level_lone[0], 0.1 * 2, 1e-4);
  EXPECT_EQ(sector.lit, sector.level_lone[0]);
  EXPECT_NEAR(sector.blocked, 0.8 * 7 * 75, 120);
}

TEST(AirCensus, LevelBeamsAndReachesAreThoseOfTheScene) {
  const AirCensus census = censusOf(scan(0));
  // Beams 0.42 deg apart: seven between -2 and 1 deg, 75 columns in a sector. The wall at 25 m
  // stops all of them; below the horizon as many return.
  EXPECT_NEAR(census.sectors[3].level, 7 * 75, 60);
  EXPECT_EQ(census.sectors[3].blocked, census.sectors[3].level);
  EXPECT_NEAR(census.sectors[3].below, 7.5 * 75, 60);  // seven or eight beams
  double far = 0;
  for (std::size_t k = 13; k < AirCensus::kReachBins; ++k) far += census.upright[k];
  EXPECT_EQ(far, 0);
  EXPECT_GT(census.upright[12], 10000);
  EXPECT_GT(census.ground[4], 100);
}

}  // namespace
}  // namespace perception
