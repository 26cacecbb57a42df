#include "libperception/simulation/lidar/LidarEcho.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

using test::skyPulse, test::wallPulse;

LidarPulse::Scatterer scatterer(double range, double power, double intensity = -1) {
  LidarPulse::Scatterer s;
  s.range = range, s.power = power, s.intensity = intensity, s.phantom = Phantom::kFog;
  return s;
}

TEST(LidarEcho, SurfaceIsReceivedUpToTheRangeOfItsReflectivity) {
  LidarSensorParams p;  // a surface of 90 % is just seen at the reference range
  p.reference_range = 100;
  EXPECT_TRUE(echoOf(wallPulse(99), 0.9, p).received);
  EXPECT_FALSE(echoOf(wallPulse(101), 0.9, p).received);
  EXPECT_TRUE(echoOf(wallPulse(49), 0.225, p).received);  // a quarter: half the range
  EXPECT_FALSE(echoOf(wallPulse(51), 0.225, p).received);
}

TEST(LidarEcho, ExtinctionCountsBothWays) {
  LidarPulse pulse = wallPulse(20);
  pulse.optical_depth = 0.5;
  const LidarEcho echo = echoOf(pulse, 0.3, {});
  ASSERT_TRUE(echo.received);
  EXPECT_TRUE(echo.of_surface);
  EXPECT_NEAR(echo.intensity, 0.3 * std::exp(-1), 1e-12);
}

TEST(LidarEcho, TheStrongestEchoIsReceived) {
  LidarPulse pulse = wallPulse(20);  // its power: 0.3 / 400
  pulse.scatterers = {scatterer(10, 0.9 * 0.3 / 400)};
  EXPECT_TRUE(echoOf(pulse, 0.3, {}).of_surface);
  pulse.scatterers = {scatterer(10, 1.1 * 0.3 / 400)};
  const LidarEcho echo = echoOf(pulse, 0.3, {});
  EXPECT_FALSE(echo.of_surface);
  EXPECT_EQ(echo.range, 10);
  EXPECT_EQ(echo.phantom, Phantom::kFog);
}

TEST(LidarEcho, TheNearestReturnOfAMeasuredLawIsReceivedInAnyCase) {
  LidarPulse pulse = wallPulse(20);
  pulse.scatterers = {scatterer(9, 0, 0.02), scatterer(5, 0, 0.01), scatterer(3, 1)};
  const LidarEcho echo = echoOf(pulse, 0.9, {});
  EXPECT_EQ(echo.range, 5);
  EXPECT_EQ(echo.intensity, 0.01);
}

TEST(LidarEcho, NothingComesThroughDirtNorFromTheSky) {
  LidarPulse pulse = wallPulse(20);
  pulse.blocked = true;
  EXPECT_FALSE(echoOf(pulse, 0.9, {}).received);
  EXPECT_FALSE(echoOf(skyPulse(0, 0.1), 0.9, {}).received);
}

TEST(LidarEcho, TheSurfaceBehindAFlakeIsASecondEcho) {
  LidarPulse pulse = wallPulse(20);
  pulse.scatterers = {scatterer(10, .02)};  // the wall's power: 0.3 / 400
  const LidarEcho first = echoOf(pulse, 0.3, {});
  ASSERT_FALSE(first.of_surface);
  const auto second = secondEchoOf(pulse, first, 0.3, {});
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->range, 20, 1e-6);
  EXPECT_FALSE(secondEchoOf(pulse, echoOf(wallPulse(20), 0.3, {}), 0.3, {}));  // no first
  EXPECT_FALSE(secondEchoOf(skyPulse(0, 0), first, 0, {}));                    // nothing behind
  pulse.scatterers = {scatterer(19.5, .02)};
  EXPECT_FALSE(secondEchoOf(pulse, echoOf(pulse, 0.3, {}), 0.3, {}));  // one echo with it
}

TEST(LidarEcho, TheLowerOrShorterFirstEchoIsRain) {
  LidarEcho first, second;
  first.level = 5, second.level = 4;
  first.width = pulseWidth(5, 0), second.width = pulseWidth(4, 0);
  EXPECT_FALSE(isRain(first, second));
  second.width = pulseWidth(4, 2);  // a road at a grazing angle
  EXPECT_TRUE(isRain(first, second));
  first.level = 3, first.width = 9;
  EXPECT_TRUE(isRain(first, second));
}

TEST(LidarEcho, PulsesAreAsLongAsTheirGaussianIsAboveTheThreshold) {
  EXPECT_EQ(pulseWidth(1, 0), 0);
  EXPECT_NEAR(pulseWidth(2, 0), 0.6, 1e-9);  // at half its height
}

}  // namespace
}  // namespace perception
