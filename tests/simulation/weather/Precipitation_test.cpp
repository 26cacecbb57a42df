#include "libperception/simulation/weather/Precipitation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Angle.h"

namespace perception {
namespace {

// Extinction by a sum over diameters [mm], cross sections as m^2.
double summed(const SizeDistribution& sizes, double efficiency) {
  double sum = 0;
  const double step = 0.001;
  for (double d = step / 2; d < 40; d += step) {
    sum += kPi / 4 * d * d * 1e-6 * efficiency * sizes.number * std::exp(-sizes.slope * d) * step;
  }
  return sum;
}

TEST(Precipitation, ExtinctionOfRainIsThatOfItsDrops) {
  for (const double rate : {0.5, 1.0, 10.0, 25.0, 50.0}) {
    EXPECT_NEAR(rainExtinction(rate) / (3.7e-4 * std::pow(rate, 0.63)), 1, 0.02) << rate;
    EXPECT_NEAR(rainExtinction(rate) / summed(marshallPalmer(rate), 2.03), 1, 0.001) << rate;
  }
  EXPECT_EQ(rainExtinction(0), 0);
}

TEST(Precipitation, ExtinctionOfSnowIsThatOfItsFlakes) {
  for (const double rate : {0.5, 1.0, 2.5, 10.0}) {
    EXPECT_NEAR(snowExtinction(rate) / (1.44e-3 * std::pow(rate, 0.57)), 1, 0.02) << rate;
    EXPECT_NEAR(snowExtinction(rate) / summed(gunnMarshall(rate), 2.0), 1, 0.001) << rate;
  }
}

TEST(Precipitation, RadarLosesADecibelInHeavyRain) {
  EXPECT_NEAR(2 * radarAttenuation(25) * 50 / 1000, 1.1, 0.05);
  EXPECT_NEAR(2 * radarAttenuation(50) * 100 / 1000, 3.8, 0.05);
}

TEST(Precipitation, ShareOfNearReturnsIsThatOfTheDrawnOnes) {
  Rng rng({3, 0, 0, 0});
  int near = 0;
  for (int i = 0; i < 20000; ++i) near += kSnowReturns.range(rng) < 5;
  EXPECT_NEAR(near / 20000.0, kSnowReturns.shareWithin(5), 0.01);
  EXPECT_NEAR(kSnowReturns.shareWithin(5), 0.589, 0.001);
}

}  // namespace
}  // namespace perception
