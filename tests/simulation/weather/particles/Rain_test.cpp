#include "libperception/simulation/weather/particles/Rain.h"

#include <gtest/gtest.h>

#include "libperception/simulation/weather/particles/Precipitation.h"
#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

TEST(Rain, FalseReturnsFollowTheMeasuredLaw) {
  Rain rain(50);
  std::vector<double> ranges;
  double intensity = 0, beams = 0;
  test::scanSky(rain, 50, [&](int, int, const LidarPulse& pulse) {
    ++beams;
    for (const auto& drop : pulse.scatterers) {
      ranges.push_back(drop.range), intensity += drop.intensity;
      EXPECT_EQ(drop.phantom, Phantom::kRain);
    }
  });
  const double count = static_cast<double>(ranges.size());
  EXPECT_NEAR(count / beams / (1.69e-4 * 50), 1, 0.1);
  EXPECT_LT(test::kolmogorovSmirnov(ranges, 1.362, 0.784), 1.63);
  EXPECT_NEAR(intensity / count * 255, 0.693, 0.05);
}

TEST(Rain, NoDropIsSeenBehindASurface) {
  const Rain rain(200);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    Rng rng({1, 0, i, 0});
    LidarPulse pulse = test::wallPulse(3);
    rain.alter(SensorParams(), pulse, rng);
    for (const auto& drop : pulse.scatterers) EXPECT_LT(drop.range, 3);
    EXPECT_NEAR(pulse.optical_depth, 3 * rainExtinction(200), 1e-9);
  }
}

TEST(Rain, ActsOnRadarAndCamera) {
  const Rain rain(25);
  Rng rng({1, 0, 0, 0});
  RadarReflection reflection;
  reflection.range = 50, reflection.snr = 100;
  rain.alter(SensorParams(), reflection, rng);
  EXPECT_NEAR(10 * std::log10(100 / reflection.snr), 1.1, 0.05);
  CameraLook look;
  look.range = 100, look.chance = 0.9, look.edge_noise = 0.02;
  rain.alter(SensorParams(), look, rng);
  EXPECT_NEAR(look.optical_depth, 0.28, 0.01);
  EXPECT_NEAR(look.edge_noise, 0.03, 1e-9);
  Lighting light;
  const double clear = light.haze;
  rain.alter(SensorParams(), light, rng);
  EXPECT_NEAR(light.haze - clear, rainExtinction(25), 1e-12);
}

TEST(Rain, ContrastBelowATwentiethIsNotDetected) {
  EXPECT_EQ(contrastRecall(0), 1);
  EXPECT_EQ(contrastRecall(1.38), 1);
  EXPECT_NEAR(contrastRecall(-std::log(0.15)), 0.5, 1e-9);
  EXPECT_EQ(contrastRecall(3), 0);
}

}  // namespace
}  // namespace perception
