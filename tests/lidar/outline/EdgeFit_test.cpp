#include "libperception/lidar/outline/EdgeFit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

/// Along two sides of a rectangle, 4 m by 1.8 m, that is turned by `yaw` [rad].
std::pair<float, float> onCorner(std::size_t i, double yaw) {
  const double along = i < 40 ? 0.1 * static_cast<double>(i) : 0,
               across = i < 40 ? 0 : 0.1 * static_cast<double>(i - 39);
  return {static_cast<float>(std::cos(yaw) * along - std::sin(yaw) * across),
          static_cast<float>(std::sin(yaw) * along + std::cos(yaw) * across)};
}

TEST(EdgeFit, FindsTheDirectionOfTheLongerSide) {
  for (const double degrees : {0.0, 3.0, 42.0, 87.0}) {
    const double yaw = radians(degrees);
    const EdgeFit fit = fitEdges({57, [&](std::size_t i) { return onCorner(i, yaw); }});
    EXPECT_NEAR(std::abs(fit.along_x), std::cos(yaw), 1e-6) << degrees;
    EXPECT_NEAR(std::abs(fit.along_y), std::sin(yaw), 1e-6) << degrees;
    EXPECT_EQ(fit.close, 57) << degrees;
    EXPECT_NEAR(fit.distance, 0, 1e-4) << degrees;
  }
}

TEST(EdgeFit, CountsPointsAwayFromTheSidesOnce) {
  const EdgeFit fit = fitEdges(
      {58, [](std::size_t i) { return i < 57 ? onCorner(i, 0) : std::make_pair(2.0f, 1.0f); }});
  EXPECT_EQ(fit.close, 57);
  EXPECT_NEAR(fit.distance, 0.7, 1e-4);  // of 1.7 m that are seen across
}

}  // namespace
}  // namespace perception
