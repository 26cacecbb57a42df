#include "libperception/core/math/Angle.h"

#include <gtest/gtest.h>

#include <limits>

namespace perception {
namespace {

TEST(Angle, WrapsIntoTheHalfOpenTurn) {
  EXPECT_DOUBLE_EQ(wrapAngle(0), 0);
  EXPECT_DOUBLE_EQ(wrapAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(wrapAngle(-kPi), kPi);
  EXPECT_NEAR(wrapAngle(3 * kPi), kPi, 1e-14);
  EXPECT_NEAR(wrapAngle(kPi + 0.1), -kPi + 0.1, 1e-14);
  EXPECT_NEAR(wrapAngle(-1000 * kTwoPi - 0.25), -0.25, 1e-10);
}

TEST(Angle, WrappedStaysInRangeAndIsTheSameDirection) {
  for (int i = -5000; i <= 5000; ++i) {
    const double angle = 0.0137 * i;
    const double wrapped = wrapAngle(angle), axis = wrapAxis(angle);
    EXPECT_GT(wrapped, -kPi);
    EXPECT_LE(wrapped, kPi);
    EXPECT_NEAR(std::sin(wrapped - angle), 0, 1e-12);
    EXPECT_GT(std::cos(wrapped - angle), 0);
    EXPECT_GT(axis, -kPi / 2);
    EXPECT_LE(axis, kPi / 2);
    EXPECT_NEAR(std::sin(axis - angle), 0, 1e-12);
  }
}

TEST(Angle, AxisHasNoFront) {
  EXPECT_NEAR(wrapAxis(kPi - 0.2), -0.2, 1e-14);
  EXPECT_DOUBLE_EQ(wrapAxis(-kPi / 2), kPi / 2);
  EXPECT_DOUBLE_EQ(wrapAxis(kPi / 2), kPi / 2);
}

TEST(Angle, NotANumberStaysOne) {
  EXPECT_TRUE(std::isnan(wrapAngle(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(std::isfinite(wrapAngle(std::numeric_limits<double>::infinity())));
}

TEST(Angle, DegreesAndRadiansAreInverse) {
  EXPECT_DOUBLE_EQ(radians(180), kPi);
  EXPECT_DOUBLE_EQ(degrees(kPi / 6), 30);
}

}  // namespace
}  // namespace perception
