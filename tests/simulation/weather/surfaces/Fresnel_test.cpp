#include "libperception/simulation/weather/surfaces/Fresnel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

double reflectanceAt(double range, double height = 1.9) {
  return waterReflectance(height / range).mean();
}

TEST(Fresnel, WetRoadIsAMirrorAtGrazingAngles) {
  EXPECT_NEAR(reflectanceAt(10), 0.32, 0.01);
  EXPECT_NEAR(reflectanceAt(20), 0.56, 0.01);
  EXPECT_NEAR(reflectanceAt(30), 0.67, 0.01);
  EXPECT_NEAR(reflectanceAt(40), 0.74, 0.01);
  EXPECT_NEAR(waterReflectance(1).mean(), 0.02, 0.001);
  EXPECT_NEAR(waterReflectance(0).mean(), 1, 1e-9);
}

TEST(Fresnel, NothingPolarizedAlongIsReflectedAtBrewstersAngle) {
  const double brewster = std::atan(1.33 / 1.0003);
  EXPECT_NEAR(waterReflectance(std::cos(brewster)).along, 0, 1e-12);
  EXPECT_GT(waterReflectance(std::cos(brewster)).across, 0.05);
}

TEST(Fresnel, FilmDarkensTheGroundMoreAndMoreWithRange) {
  EXPECT_NEAR(filmFactor(0.17, 1), 0.96, 0.01);
  double before = 1;
  for (const double range : {5.0, 10.0, 20.0, 40.0}) {
    const double factor = filmFactor(0.17, 1.9 / range);
    EXPECT_LT(factor, before);
    before = factor;
  }
  EXPECT_LT(filmFactor(0.17, 1.9 / 40), 0.15);
}

TEST(Fresnel, FilmOfMoreThanAMillimeterClosesTheRoad) {
  EXPECT_EQ(wetShare(0), 0);
  EXPECT_NEAR(wetShare(0.6), 0.5, 1e-12);
  EXPECT_EQ(wetShare(3), 1);
}

}  // namespace
}  // namespace perception
