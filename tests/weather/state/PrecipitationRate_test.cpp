#include "libperception/weather/state/PrecipitationRate.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(PrecipitationRate, ReturnsFarAndNearFollowTheMeasuredLaw) {
  const PrecipitationRate rates;
  // 59.7 % of the measured law's returns lie between 1.5 and 6 m, 77.8 % within 10 m.
  EXPECT_NEAR(rates.rain(1.69e-4 * 0.597 * 20, 0.1, false).value, 20, 1e-9);
  EXPECT_NEAR(rates.snow(0.01569 * 0.778 * 2.5).value, 2.5, 1e-9);
}

TEST(PrecipitationRate, DropsNearByGiveRatesThatGrowWithTheirShareOfOpenBeams) {
  const PrecipitationRate rates;
  double before = 0;
  for (const double near : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    const Estimate rain = rates.rain(near, 0.2, true);
    EXPECT_GT(rain.value, before);
    EXPECT_LT(rain.low, rain.value);
    EXPECT_GT(rain.high, rain.value);
    EXPECT_GT(rain.value, rates.rain(near, 0.4, true).value);
    before = rain.value;
  }
}

TEST(PrecipitationRate, MoreFlakesThanTheLawKnowsLeaveLimitsAlone) {
  const PrecipitationRate rates;
  const Estimate snow = rates.snow(0.2);
  EXPECT_NEAR(snow.high, 0.2 / (0.01569 * 0.778), 1e-9);
  EXPECT_EQ(snow.low, 0.3);
  EXPECT_LT(snow.value, 6);
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
