#include "libperception/simulation/weather/particles/RainDrops.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/particles/ParticleReceiver.h"
#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

// Expected number of drops above the threshold in a beam to the sky, by the integral over range
// and diameter of [kilic2021]'s equations.
double expectedDrops(double mm_h) {
  const double slope = 4.1 * std::pow(mm_h, -0.21), depth = rainExtinction(mm_h);
  const double fresnel = std::pow(0.328 / 2.328, 2), weakest = 0.9 / (120.0 * 120);
  double sum = 0;
  constexpr double dr = 0.001;
  for (double r = 1.5; r < 8; r += dr) {
    const double beam = 0.003 * r;
    // [mm] at the threshold; where even a drop as wide as the beam is too faint there is none.
    const double filled = weakest * r * r * std::exp(2 * depth * r) / fresnel;
    if (filled > 1) break;
    const double least = 1e3 * beam * std::sqrt(filled);
    sum += kPi / 4 * beam * beam * 8000 / slope * std::exp(-slope * least) * dr;
  }
  return sum;
}

TEST(RainDrops, AsManyAreReceivedAsTheSizesAndTheThresholdSay) {
  for (const double mm_h : {5.0, 50.0}) {
    RainDrops rain(mm_h);
    double count = 0, beams = 0;
    test::scanSky(rain, 60, [&](int, int, const LidarPulse& pulse) {
      ++beams, count += static_cast<double>(pulse.scatterers.size());
    });
    EXPECT_NEAR(count / beams / expectedDrops(mm_h), 1, 0.03) << mm_h;
  }
}

TEST(RainDrops, AllAreAboveTheThresholdAndBeyondTheOverlap) {
  RainDrops rain(50);
  int seen = 0;
  test::scanSky(rain, 2, [&](int, int, const LidarPulse& pulse) {
    for (const auto& drop : pulse.scatterers) {
      ++seen;
      EXPECT_GE(drop.range, 1.5);
      EXPECT_GE(drop.power, ParticleReceiver::kWeakest);
      EXPECT_LT(drop.intensity, 0);  // the power decides
      EXPECT_EQ(drop.phantom, Phantom::kRain);
    }
  });
  EXPECT_GT(seen, 100);
}

TEST(RainDrops, NoDropIsSeenBehindASurface) {
  const RainDrops rain(200);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    Rng rng({1, 0, i, 0});
    LidarPulse pulse = test::wallPulse(2);
    rain.alter(SensorParams(), pulse, rng);
    for (const auto& drop : pulse.scatterers) EXPECT_LT(drop.range, 2);
    EXPECT_NEAR(pulse.optical_depth, 2 * rainExtinction(200), 1e-9);
  }
}

}  // namespace
}  // namespace perception
