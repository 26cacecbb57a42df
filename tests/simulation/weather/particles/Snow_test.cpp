#include "libperception/simulation/weather/particles/Snow.h"

#include <gtest/gtest.h>

#include <map>

#include "libperception/simulation/lidar/LidarEcho.h"
#include "libperception/simulation/weather/particles/Precipitation.h"
#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

TEST(Snow, FalseReturnsFollowTheMeasuredLaw) {
  Snow snow(2.5, 7);
  double returns = 0, beams = 0;
  std::vector<double> alone;  // those of large flakes are not independent
  std::map<double, int> flakes;
  test::scanSky(snow, 60, [&](int, int, const LidarPulse& pulse) {
    ++beams;
    returns += pulse.scatterers.empty() ? 0 : 1;
    for (const auto& flake : pulse.scatterers) ++flakes[flake.range];
  });
  EXPECT_NEAR(returns / beams / (0.01569 * 2.5), 1, 0.1);
  for (const auto& flake : flakes) alone.push_back(flake.first);
  // Large flakes count once here, so the near half has fewer than the law's share.
  const auto near = std::count_if(alone.begin(), alone.end(), [](double r) { return r < 5; });
  EXPECT_LT(static_cast<double>(near) / static_cast<double>(alone.size()),
            kSnowReturns.shareWithin(5));
  std::vector<double> all;
  for (const auto& [range, count] : flakes)
    all.insert(all.end(), static_cast<std::size_t>(count), range);
  const auto close = std::count_if(all.begin(), all.end(), [](double r) { return r < 5; });
  EXPECT_NEAR(static_cast<double>(close) / static_cast<double>(all.size()),
              kSnowReturns.shareWithin(5), 0.02);
  double log_sum = 0, square_sum = 0;
  for (const double r : all) log_sum += std::log(r), square_sum += std::log(r) * std::log(r);
  const double n = static_cast<double>(all.size()), mean = log_sum / n;
  EXPECT_NEAR(mean, 1.433, 0.03);
  EXPECT_NEAR(std::sqrt(square_sum / n - mean * mean), 0.787, 0.02);
}

TEST(Snow, FarReturnsAreDistributedByTheMeasuredLaw) {
  Snow snow(10, 7);
  // Beyond 5 m all are independent: the law's tail is mapped to the whole of it.
  std::vector<double> far;
  test::scanSky(snow, 20, [&](int, int, const LidarPulse& pulse) {
    for (const auto& flake : pulse.scatterers)
      if (flake.range > 5) far.push_back(flake.range);
  });
  ASSERT_GT(far.size(), 5000u);
  std::sort(far.begin(), far.end());
  const double within = kSnowReturns.shareWithin(5), n = static_cast<double>(far.size());
  double most = 0;
  for (std::size_t i = 0; i < far.size(); ++i) {
    const double law = (kSnowReturns.shareWithin(far[i]) - within) / (1 - within);
    most = std::max(most, std::abs(law - (static_cast<double>(i) + .5) / n));
  }
  EXPECT_LT(most * std::sqrt(n), 1.63);
}

TEST(Snow, LargeFlakesFillNeighboringBeamsBrightly) {
  Snow snow(2.5, 7);
  std::map<double, int> flakes;  // beams by range, which no two flakes share
  std::map<double, double> brightness;
  test::scanSky(snow, 60, [&](int, int, const LidarPulse& pulse) {
    for (const auto& flake : pulse.scatterers)
      ++flakes[flake.range], brightness[flake.range] = flake.power * flake.range * flake.range;
  });
  int several = 0, of_them_far = 0, dim = 0, most = 0;
  for (const auto& [range, beams] : flakes) {
    if (beams < 2) continue;
    ++several, of_them_far += range > 5, dim += brightness[range] < 0.18;
    most = std::max(most, beams);
  }
  EXPECT_GT(several, 150);
  EXPECT_EQ(of_them_far, 0);
  EXPECT_EQ(dim, 0);
  EXPECT_LE(most, 6);
}

TEST(Snow, EveryFlakeInFrontOfTheSkyIsReceived) {
  Snow snow(2.5, 7);
  const LidarSensorParams lidar;
  int flakes = 0, dark = 0;
  test::scanSky(snow, 20, [&](int, int, const LidarPulse& pulse) {
    if (pulse.scatterers.empty() || pulse.scatterers.front().range < lidar.range_min) return;
    const LidarEcho echo = echoOf(pulse, 0, lidar);
    ++flakes, dark += echo.intensity < .5 / 255;
    EXPECT_TRUE(echo.received);
    EXPECT_EQ(echo.phantom, Phantom::kSnow);
  });
  EXPECT_GT(flakes, 5000);
  EXPECT_GT(dark, flakes / 4);  // instruments of 8 bits report no intensity
}

// By a sum over ranges and diameters, of the flakes whose echo (57) detects.
double detectableFlakes(double mm_h, const LidarSensorParams& lidar, double nearer_than) {
  constexpr double kStep = .01, kThin = .01;  // [m], [mm]
  const SizeDistribution sizes = gunnMarshall(mm_h);
  double sum = 0;
  for (double r = kStep / 2; r < nearer_than; r += kStep) {
    const double width = .003 * r;
    for (double d = kThin / 2; d < 40; d += kThin) {
      const double intensity = .9 * std::pow(1e-3 * d / width, 2);
      if (intensity / (r * r) < .9 / (lidar.reference_range * lidar.reference_range)) continue;
      sum += sizes.number * std::exp(-sizes.slope * d) * kThin * kPi / 4 * width * width * kStep;
    }
  }
  return sum;
}

TEST(Snow, BySizesHasTheFlakesThatTheLidarDetects) {
  LidarSensorParams lidar;
  lidar.reference_range = 120;
  Snow snow(2.5, 7, true);
  std::vector<double> ranges;
  double beams = 0;
  test::scanSky(
      snow, 4,
      [&](int, int, const LidarPulse& pulse) {
        ++beams;
        for (const auto& flake : pulse.scatterers) {
          ranges.push_back(flake.range);
          LidarPulse alone = pulse;
          alone.scatterers = {flake};
          EXPECT_TRUE(flake.range < lidar.range_min || echoOf(alone, 0, lidar).received);
        }
      },
      lidar.reference_range);
  const auto nearer = [&](double m) {
    return static_cast<double>(
               std::count_if(ranges.begin(), ranges.end(), [&](double r) { return r < m; })) /
           beams;
  };
  for (const double m : {3., 6., 12., 40.})
    EXPECT_NEAR(nearer(m) / detectableFlakes(2.5, lidar, m), 1, .05) << m;
}

// Share of flakes that hide a wall of 30 % at `range`.
double shareBefore(double range) {
  Snow snow(10, 7);
  const World world(test::scenarioOf(test::kStanding + test::kRoofLidar));
  const SensorParams& sensor = world.scenario().sensors.front();
  snow.advance(world, sensor, 0);
  double flakes = 0, received = 0;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    Rng rng({5, 0, i, 1});
    LidarPulse pulse = test::wallPulse(range);
    pulse.azimuth = radians(.0036) * i;
    snow.alter(sensor, pulse, rng);
    if (pulse.scatterers.empty()) continue;
    ++flakes, received += !echoOf(pulse, pulse.reflectivity, LidarSensorParams()).of_surface;
  }
  return received / flakes;
}

TEST(Snow, TheStrongerEchoHidesTheOther) {
  const double near = shareBefore(15), middle = shareBefore(50), far = shareBefore(150);
  EXPECT_LT(near, .5);
  EXPECT_LT(near + .1, middle);
  EXPECT_LT(middle + .02, far);
  EXPECT_GT(far, .9);
}

TEST(Snow, FlakesDifferFromScanToScanAndAreRepeated) {
  const auto ranges = [](std::uint64_t seed) {
    Snow snow(2.5, seed);
    std::vector<double> all;
    test::scanSky(snow, 2, [&](int, int, const LidarPulse& pulse) {
      for (const auto& flake : pulse.scatterers) all.push_back(flake.range);
    });
    return all;
  };
  EXPECT_EQ(ranges(7), ranges(7));
  EXPECT_NE(ranges(7), ranges(8));
}

TEST(Snow, HalvesTheCamerasRecallWhenHeavy) {
  CameraLook look;
  look.range = 10, look.chance = 0.8;
  Rng rng({1, 0, 0, 0});
  Snow(2.5, 1).alter(SensorParams(), look, rng);
  EXPECT_NEAR(look.chance, 0.4, 1e-12);
  EXPECT_NEAR(look.optical_depth, 10 * 1.44e-3 * std::pow(2.5, 0.57), 1e-3);
}

}  // namespace
}  // namespace perception
