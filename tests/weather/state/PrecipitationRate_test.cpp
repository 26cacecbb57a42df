#include "libperception/weather/state/PrecipitationRate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

AirShares drops(double share) {
  AirShares shares;
  shares.drops = share, shares.few_far = true;
  return shares;
}

AirShares flakes(double share, double brightness = 0) {
  AirShares shares;
  shares.flakes = share, shares.brightness = brightness;
  return shares;
}

TEST(PrecipitationRate, ReturnsFarAndNearFollowTheMeasuredLaw) {
  const PrecipitationRate rates;
  // 59.7 % of the measured law's returns lie between 1.5 and 6 m, 77.8 % within 10 m.
  AirShares shares;
  shares.all = 1.69e-4 * 0.597 * 20;
  EXPECT_NEAR(rates.rain(shares).value, 20, 1e-9);
  EXPECT_NEAR(rates.snow(flakes(0.01569 * 0.778 * 2.5)).value, 2.5, 1e-9);
}

TEST(PrecipitationRate, DropsNearByGiveRatesThatGrowWithTheirShareOfOpenBeams) {
  const PrecipitationRate rates;
  double before = 0;
  for (const double near : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    const Estimate rain = rates.rain(drops(near / 0.2));
    EXPECT_GT(rain.value, before);
    EXPECT_LT(rain.low, rain.value);
    EXPECT_GT(rain.high, rain.value);
    EXPECT_GT(rain.value, rates.rain(drops(near / 0.4)).value);
    before = rain.value;
  }
}

// At 10 mm/h an HDL-64E of 120 m detects 0.02095 drops from 1.5 to 4 m in a beam: pi/4 (3 mrad)^2
// 8000 / 2.53 times the integral of r^2 exp(-2.53 0.168 r^2). One of 200 m detects as many at 1.94.
TEST(PrecipitationRate, TheReachOfTheInstrumentSaysWhichDropsItSees) {
  const AirShares seen = drops(1 - std::exp(-0.02095));
  PrecipitationRate rates;
  rates.setReach(120);
  const Estimate known = rates.rain(seen);
  EXPECT_NEAR(known.value, 10, 0.05);
  rates.setReach(200);
  EXPECT_NEAR(rates.rain(seen).value, 1.94, 0.02);
  rates.setReach(0);
  const Estimate unknown = rates.rain(seen);
  EXPECT_GT(unknown.high / unknown.low, known.high / known.low);
}

TEST(PrecipitationRate, MoreFlakesThanTheLawKnowsLeaveLimitsAlone) {
  const PrecipitationRate rates;
  const Estimate snow = rates.snow(flakes(0.2));
  EXPECT_NEAR(snow.high, 0.2 / (0.01569 * 0.778), 1e-9);
  EXPECT_EQ(snow.low, 0.3);
  EXPECT_LT(snow.value, 6);
}

// [gunn1958] at 2 mm/h: flakes of 1 / 2.55 2^0.48 = 0.547 mm in the mean, which fill 0.547 mm / (3
// mrad r) of the beam and send back 0.9 of that, times 1.092 less 0.285 times 0.547 / 3.
TEST(PrecipitationRate, WhereEveryBeamMeetsFlakesTheirBrightnessTellsTheRate) {
  const PrecipitationRate rates;
  const Estimate snow = rates.snow(flakes(0.5, 0.9 * 0.1823 * (1.092 - 0.285 * 0.1823)));
  EXPECT_NEAR(snow.value, 2, 0.01);
  EXPECT_LT(snow.high, 2 * snow.value) << "the share's limits are wider";
  EXPECT_GT(rates.snow(flakes(0.5, 0.3)).value, snow.value);
}

TEST(PrecipitationRate, TheBrightnessOfSimulatedFlakesGivesTheRateBack) {
  for (const double mm_h : {0.5, 1.0, 2.5, 5.0}) {
    AirShares shares;
    shares.flakes = 1, shares.brightness = test::brightnessOf(SnowFlakes(mm_h, 1));
    EXPECT_NEAR(PrecipitationRate().snow(shares).value / mm_h, 1, 0.06) << mm_h;
  }
}

TEST(PrecipitationRate, VisibilityIsThatInWhichASurfaceIsJustReceived) {
  // exp(-2 alpha 30 m) 0.2 / (30 m)^2 = 0.9 / (200 m)^2 at alpha = 0.0381/m; ln 20 / alpha.
  const Estimate visibility = visibilityOfReach(30);
  EXPECT_NEAR(visibility.value, 78.5, 0.5);
  EXPECT_LT(visibility.low, visibility.value);
  EXPECT_GT(visibility.high, visibility.value);
  EXPECT_GT(visibilityOfReach(80).value, visibilityOfReach(40).value);
}

}  // namespace
}  // namespace perception
