#include "libperception/simulation/weather/particles/Fog.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

// The convolution as an integral over time [s] by Simpson's rule, range by range.
double integral(double range, double extinction) {
  const double c = 299792458, tau = 20e-9;
  const int n = 4000;
  const double h = 2 * tau / n;
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const double t = i * h, r = range - c * t / 2;
    if (r <= 0.9) continue;
    const double s = std::sin(kPi * t / (2 * tau)), seen = std::min(1.0, (r - 0.9) / 0.1);
    const double f = s * s * std::exp(-2 * extinction * r) / (r * r) * seen;
    sum += f * (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2);
  }
  return sum * h / 3;
}

TEST(Fog, VisibilityIsWhereContrastFallsToFivePercent) {
  EXPECT_NEAR(fogExtinction(50), 0.06, 1e-3);
  EXPECT_NEAR(fogExtinction(150), 0.02, 1e-4);
  EXPECT_NEAR(std::exp(-fogExtinction(80) * 80), 0.05, 1e-12);
}

TEST(Fog, EchoIsWhereTheIntegralIsLargest) {
  for (const double mor : {30.0, 50.0, 150.0, 600.0}) {
    const double extinction = fogExtinction(mor);
    const FogEcho echo(extinction);
    for (const double surface : {3.0, 4.5, 20.0, 80.0}) {
      double best = 0, at = 0;
      for (double r = 0.9; r <= std::min(surface, 20.0) + 1e-9; r += 0.01) {
        const double value = integral(r, extinction);
        if (value > best) best = value, at = r;
      }
      const FogEcho::Peak peak = echo.before(surface + 1e-6);
      EXPECT_NEAR(peak.range, at, 0.1) << mor << " m, surface at " << surface;
      EXPECT_NEAR(peak.value / (best * 299792458 / 2), 1, 0.02) << mor << ", " << surface;
    }
  }
}

// Range and power of the fog's echo and of the surface's, without the threshold.
bool fogWins(const Fog& fog, double surface, std::uint32_t beam) {
  Rng rng({1, 0, beam, 0});
  LidarPulse pulse = test::wallPulse(surface);
  fog.alter(SensorParams(), pulse, rng);
  const double hard = pulse.reflectivity * std::exp(-2 * pulse.optical_depth) / surface / surface;
  return !pulse.scatterers.empty() && pulse.scatterers.front().power > hard;
}

TEST(Fog, ReplacesFarSurfacesAndKeepsNearOnes) {
  const Fog dense(50);
  EXPECT_FALSE(fogWins(dense, 15, 0));
  EXPECT_TRUE(fogWins(dense, 40, 0));
  const Fog thin(600);
  EXPECT_FALSE(fogWins(thin, 40, 0));
}

TEST(Fog, EchoLiesBeforeTheSurfaceWithinAFactorOfTwo) {
  const Fog fog(50);
  const double peak = FogEcho(fogExtinction(50)).before(1e9).range;
  double least = 1e9, most = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Rng rng({1, 0, i, 0});
    LidarPulse pulse = test::skyPulse(0, 0.1);
    fog.alter(SensorParams(), pulse, rng);
    least = std::min(least, pulse.scatterers.front().range);
    most = std::max(most, pulse.scatterers.front().range);
    LidarPulse near = test::wallPulse(5);
    near.reflectivity = 0;
    fog.alter(SensorParams(), near, rng);
    EXPECT_LE(near.scatterers.front().range, 5);
  }
  EXPECT_NEAR(least, peak / 2, 0.02);
  EXPECT_NEAR(most, 2 * peak, 0.05);
}

TEST(Fog, HidesFromTheCameraWhatIsBeyondSight) {
  const Fog fog(50);
  Rng rng({1, 0, 0, 0});
  CameraLook look;
  look.range = 50;
  fog.alter(SensorParams(), look, rng);
  EXPECT_NEAR(contrastRecall(look.optical_depth), 0, 1e-9);
  look = {};
  look.range = 20;
  fog.alter(SensorParams(), look, rng);
  EXPECT_EQ(contrastRecall(look.optical_depth), 1);
}

}  // namespace
}  // namespace perception
