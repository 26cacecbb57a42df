#include "libperception/simulation/weather/particles/SnowFlakes.h"

#include <gtest/gtest.h>

#include "libperception/simulation/weather/particles/ParticleReceiver.h"
#include "libperception/simulation/weather/particles/Precipitation.h"
#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

// Flakes in the plane of a scan line [1/m^2] and their mean diameter [m], [hahner2022].
double perSquareMeter(double mm_h) {
  const double filled = mm_h / (3.6e6 * 0.1 * 1), d = 1e-3 / (2.55 * std::pow(mm_h, -0.48));
  return filled / (kPi / 2 * d * d);
}
double meanDiameter(double mm_h) { return 1e-3 / (2.55 * std::pow(mm_h, -0.48)); }

TEST(SnowFlakes, ShadeAWallByTheirAngularUnion) {
  const SnowFlakes snow(2.5, 1);
  double kept = 0;
  constexpr std::uint32_t kPulses = 20000;
  for (std::uint32_t i = 0; i < kPulses; ++i) {
    Rng rng({1, 0, i, 0});
    LidarPulse pulse = test::wallPulse(10);
    snow.alter(SensorParams(), pulse, rng);
    kept += pulse.reflectivity / 0.3;
    EXPECT_EQ(pulse.optical_depth, 0);  // every flake before the wall was drawn
  }
  // Of a point across the beam: no flake covers it.
  const double open = std::exp(-perSquareMeter(2.5) * meanDiameter(2.5) * 10);
  EXPECT_NEAR(kept / kPulses, open, 0.01);
}

TEST(SnowFlakes, AreSeenFartherTheHeavierItSnows) {
  double mean[2], share[2];
  const double rates[] = {0.5, 5};
  for (int k = 0; k < 2; ++k) {
    SnowFlakes snow(rates[k], 1);
    double sum = 0, beams = 0, count = 0;
    test::scanSky(snow, 2, [&](int, int, const LidarPulse& pulse) {
      ++beams;
      const LidarPulse::Scatterer* strongest = nullptr;
      for (const auto& flake : pulse.scatterers) {
        EXPECT_GE(flake.power, ParticleReceiver::kWeakest);
        EXPECT_GE(flake.range, ParticleReceiver::kNearest);
        EXPECT_EQ(flake.phantom, Phantom::kSnow);
        if (strongest == nullptr || flake.power > strongest->power) strongest = &flake;
      }
      if (strongest == nullptr) return;
      ++count, sum += strongest->range;
    });
    mean[k] = sum / count, share[k] = count / beams;
  }
  EXPECT_GT(mean[1], 1.1 * mean[0]);
  EXPECT_GT(share[1], 1.1 * share[0]);
}

TEST(SnowFlakes, EchoesWithinAPulseAddUp) {
  // In snow this dense a pulse of 3 m holds several flakes: peaks exceed what one flake can give.
  SnowFlakes snow(20, 1);
  double most = 0;
  test::scanSky(snow, 1, [&](int, int, const LidarPulse& pulse) {
    for (const auto& flake : pulse.scatterers)
      most = std::max(most, flake.power * flake.range * flake.range);
  });
  EXPECT_GT(most, 0.9);
}

TEST(SnowFlakes, AreDimmerInAWiderBeamAndWhereTheyReflectLess) {
  const double usual = test::brightnessOf(SnowFlakes(1, 1));
  EXPECT_NEAR(test::brightnessOf(SnowFlakes(1, 1, {0.006, 0.9})) / usual, 0.5, 0.05);
  EXPECT_NEAR(test::brightnessOf(SnowFlakes(1, 1, {0.003, 0.45})) / usual, 0.5, 0.05);
}

}  // namespace
}  // namespace perception
