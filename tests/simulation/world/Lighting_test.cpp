#include "libperception/simulation/world/Lighting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/simulation/weather/particles/Fog.h"

namespace perception {
namespace {

TEST(Lighting, ContrastIsFivePercentWhereSightEnds) {
  Lighting light;
  light.haze = fogExtinction(80);
  const Vector3 ahead = Vector3::UnitX();
  const double near = light.through(Rgb::Zero(), 0, ahead).y() - light.sky(ahead).y(),
               far = light.through(Rgb::Zero(), 80, ahead).y() - light.sky(ahead).y();
  EXPECT_NEAR(far / near, 0.05, 1e-9);  // Koschmieder
}

TEST(Lighting, BytesAndRadianceAreInverses) {
  const Lighting light;
  for (int byte = 0; byte < 256; ++byte) {
    const double linear = linearOf(static_cast<std::uint8_t>(byte));
    EXPECT_EQ(displayByte(linear), byte);
    const Rgb value = Rgb::Constant(linear);
    EXPECT_EQ(displayByte(light.exposed(light.radianceOf(value)).x()), byte);
  }
}

TEST(Lighting, HeadlightsFallWithTheSquareOfTheRangeAndLightTheRoadAhead) {
  Lighting light;
  light.haze = 0, light.headlights = 0.2, light.headlights_azimuth = radians(90);
  const Vector3 road = Vector3(0, 1, -0.1).normalized();
  const double down = std::atan(.1) / radians(15), shape = std::exp(-.5 * down * down);
  EXPECT_NEAR(light.headlightsOn(road, 10), shape * 0.2 / 100, 1e-12);
  EXPECT_NEAR(light.headlightsOn(road, 20) / light.headlightsOn(road, 10), 0.25, 1e-12);
  EXPECT_LT(light.headlightsOn(Vector3::UnitX(), 10), 1e-6);
  EXPECT_LT(light.headlightsOn(-Vector3::UnitZ(), 2), 1e-6);  // below the camera
  const Vector3 sign = Vector3(0, 1, 0.1).normalized();       // above the cut-off
  EXPECT_NEAR(light.headlightsOn(sign, 10), 0.03 * 0.2 / 100, 1e-12);
  light.haze = 0.01;
  EXPECT_NEAR(light.headlightsOn(road, 10), shape * 0.2 / 100 * std::exp(-.1), 1e-12);
  EXPECT_EQ(Lighting().headlightsOn(road, 10), 0);
}

}  // namespace
}  // namespace perception
