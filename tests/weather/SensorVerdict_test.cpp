#include "libperception/weather/SensorVerdict.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// Two echoes of one pulse, at 6 and 12 m.
LidarCloud twoEchoes() {
  LidarCloud cloud;
  cloud.x = {6, 12}, cloud.y = {0, 0}, cloud.z = {0.5F, 1};
  cloud.echo = {0, 1};
  cloud.intensity = {0.2F, 0.4F};
  return cloud;
}

TEST(SensorVerdict, RainAndDirtAreLabeledPhantomsAndObjectsAreNot) {
  LidarCloud cloud = twoEchoes();
  EXPECT_EQ(labelOdds(cloud, 0, {}), 0) << "no labels";
  const auto oddsOf = [&](PointLabel label) {
    cloud.label.assign(2, static_cast<std::uint8_t>(label));
    return labelOdds(cloud, 0, {});
  };
  EXPECT_EQ(oddsOf(PointLabel::kRain), 4);
  EXPECT_EQ(oddsOf(PointLabel::kDirt), 4);
  EXPECT_EQ(oddsOf(PointLabel::kObject), 0);
  EXPECT_EQ(oddsOf(PointLabel::kGround), 0);
}

TEST(SensorVerdict, AWeakerFirstEchoIsRainAndTheLastIsNot) {
  LidarCloud cloud = twoEchoes();
  EXPECT_EQ(echoOdds(cloud, 0, {}), 2);
  EXPECT_EQ(echoOdds(cloud, 1, {}), 0);
  cloud.intensity = {0.5F, 0.4F};
  EXPECT_EQ(echoOdds(cloud, 0, {}), 0) << "stronger";
  cloud.pulse_width = {0.1F, 0.2F};
  EXPECT_EQ(echoOdds(cloud, 0, {}), 2) << "shorter";
}

TEST(SensorVerdict, EchoesOfDifferentPulsesSayNothing) {
  LidarCloud cloud = twoEchoes();
  cloud.y[1] = 3;
  EXPECT_EQ(echoOdds(cloud, 0, {}), 0);
  cloud = twoEchoes();
  cloud.echo.clear();
  EXPECT_EQ(echoOdds(cloud, 0, {}), 0) << "one echo a pulse";
}

}  // namespace
}  // namespace perception
