#include "libperception/simulation/RadarClutter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/weather/particles/Precipitation.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kStanding, test::scenarioOf;

RadarUnitParams unit() {
  RadarUnitParams p;
  p.fov = radians(16);  // four cells
  return p;
}

RadarAir rain(double mm_h) {
  RadarAir air;
  air.backscatter = radarBackscatter(mm_h);
  return air;
}

double perScan(const RadarAir& air, int scans = 400) {
  std::size_t count = 0;
  for (int i = 0; i < scans; ++i) {
    Rng rng({1, static_cast<std::uint64_t>(i), 0, 0});
    count += radarClutter(air, unit(), {}, rng).size();
  }
  return static_cast<double>(count) / scans;
}

TEST(RadarClutter, RainFallsWithTheSquareOfTheRange) {
  const RadarAir air = rain(50);
  EXPECT_NEAR(clutterRatio(air, 30, unit()) / clutterRatio(air, 60, unit()), 4, 1e-9);
  // 50 mm/h, 40 m: 1.89e-3 / m of 4.1 cubic meters in five cells of range rate, against a car.
  const double volume = .5665 * 1600 * radians(4) * radians(5) * 0.75;
  EXPECT_NEAR(clutterRatio(air, 40, unit()), 1.888e-3 * volume / 5 / 10 * carSnr(40, unit()), .01);
}

TEST(RadarClutter, NumberIsThatOfTheCellsAboveTheThreshold) {
  const RadarAir air = rain(50);
  double expected = 0;
  for (int k = 0; k < 198; ++k) {
    const double range = 1 + .75 * (k + .5);
    if (range > 150 || (range > 20 && clutterRatio(air, range, unit()) < .05)) break;
    expected += 4 * 5 * std::pow(1e-6, 1 / (1 + clutterRatio(air, range, unit())));
  }
  EXPECT_GT(expected, .5);
  EXPECT_NEAR(perScan(air) / expected, 1, .15);
  EXPECT_LT(perScan(rain(1)), .01);
  EXPECT_LT(perScan(rain(10)), .3 * perScan(air));
}

TEST(RadarClutter, DropsStandStillOnTheAverage) {
  RadarMount mount;
  mount.velocity = {10, 0};
  double sum = 0, squares = 0, n = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    Rng rng({1, i, 0, 0});
    for (const auto& r : radarClutter(rain(100), unit(), mount, rng)) {
      const double rate = r.range_rate + 10 * std::cos(r.bearing);
      sum += rate, squares += rate * rate, ++n;
      EXPECT_GE(r.snr, -std::log(unit().false_alarm));
      EXPECT_LE(std::abs(r.bearing), .5 * unit().fov + 1e-9);
    }
  }
  ASSERT_GT(n, 200);
  EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 4 * std::sqrt(2 / n));
}

TEST(RadarClutter, ClearAirDrawsNothing) {
  Rng used({1, 0, 0, 0}), fresh({1, 0, 0, 0});
  EXPECT_TRUE(radarClutter({}, unit(), {}, used).empty());
  EXPECT_EQ(used.uniform(), fresh.uniform());
}

TEST(RadarClutter, ABlindedRadarReportsNeitherRainNorRoad) {
  const World world(scenarioOf(kStanding + kCamera));
  const LidarCaster caster(world);
  RadarUnitParams p = unit();
  p.ground_per_scan = 2, p.false_per_scan = 0;
  const auto targets = [&](double radome_db, const RadarAir& outside) {
    const double passing = std::pow(10, -.2 * radome_db);
    RadarAir air = outside;
    air.passing = passing;
    const RadarHook hook = [&](RadarReflection& r, Rng&) { r.snr *= passing; };
    std::size_t count = 0;
    for (std::uint64_t i = 0; i < 200; ++i)
      count += radarReturns(caster, 0, p, {}, {1, i, 0, 1}, hook, air).returns.size();
    return count;
  };
  EXPECT_GT(targets(0, rain(50)), 500U);
  EXPECT_NEAR(static_cast<double>(targets(0, {})), 400, 80);
  EXPECT_LT(targets(3, {}), targets(0, {}));
  EXPECT_EQ(targets(30, rain(50)), 0U);
}

}  // namespace
}  // namespace perception
