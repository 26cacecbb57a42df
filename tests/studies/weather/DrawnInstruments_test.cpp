#include "studies/weather/DrawnInstruments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

TEST(DrawnInstruments, NineInTenAreWithinATenthOfTheUsualOne) {
  const auto lidars = drawnInstruments(200, 1);
  ASSERT_EQ(lidars.size(), 200U);
  int near = 0;
  double sum = 0;
  for (const DrawnInstrument& lidar : lidars) {
    const double off = std::log(lidar.divergence_mrad / 3);
    near += std::abs(off) <= std::log(1.1);
    sum += off;
    EXPECT_LE(lidar.flake_reflectivity, 1) << "no flake sends back more than it receives";
  }
  EXPECT_EQ(near, 180);
  EXPECT_NEAR(sum, 0, 1e-9);
}

TEST(DrawnInstruments, DivergenceAndReflectivityAreIndependentAndFollowTheSeed) {
  const auto lidars = drawnInstruments(200, 1), same = drawnInstruments(200, 1),
             other = drawnInstruments(200, 2);
  double product = 0, square = 0;
  bool differs = false;
  for (std::size_t k = 0; k < lidars.size(); ++k) {
    const double d = std::log(lidars[k].divergence_mrad / 3),
                 r = std::log(lidars[k].flake_reflectivity / 0.9);
    product += d * r, square += d * d;
    EXPECT_EQ(lidars[k].divergence_mrad, same[k].divergence_mrad);
    differs = differs || lidars[k].divergence_mrad != other[k].divergence_mrad;
  }
  EXPECT_LT(std::abs(product / square), 0.2);
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace perception
