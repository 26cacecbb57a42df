#include "libperception/core/math/LogMath.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace perception {
namespace {

TEST(LogMath, AddsWithoutOverflowOrUnderflow) {
  EXPECT_DOUBLE_EQ(logAddExp(std::log(0.3), std::log(0.5)), std::log(0.8));
  EXPECT_DOUBLE_EQ(logAddExp(1000, 1000), 1000 + std::log(2.0));
  EXPECT_DOUBLE_EQ(logAddExp(-1000, -1000), -1000 + std::log(2.0));
  EXPECT_DOUBLE_EQ(logAddExp(0, -800), 0);
  EXPECT_DOUBLE_EQ(logAddExp(kMinusInfinity, -3), -3);
  EXPECT_EQ(logAddExp(kMinusInfinity, kMinusInfinity), kMinusInfinity);
}

TEST(LogMath, SumOfARangeIsTheRepeatedAddition) {
  const std::vector<double> values = {-700, -701.5, kMinusInfinity, -699.25};
  double sum = kMinusInfinity;
  for (const double v : values) sum = logAddExp(sum, v);
  EXPECT_NEAR(logSumExp(values), sum, 1e-12);
  EXPECT_EQ(logSumExp(std::vector<double>{}), kMinusInfinity);
}

TEST(LogMath, NormalisedSumsToOneAndReturnsTheSumBefore) {
  std::array<double, 3> values = {-2000, -2001, -2003};
  const double before = logSumExp(values);
  EXPECT_DOUBLE_EQ(logNormalize(values), before);
  EXPECT_NEAR(std::exp(values[0]) + std::exp(values[1]) + std::exp(values[2]), 1, 1e-12);
  EXPECT_NEAR(values[0] - values[1], 1, 1e-12);
}

TEST(LogMath, NothingLikelyBecomesUniform) {
  std::vector<double> values(4, kMinusInfinity);
  EXPECT_EQ(logNormalize(values), kMinusInfinity);
  for (const double v : values) EXPECT_DOUBLE_EQ(v, std::log(0.25));
}

TEST(LogMath, SigmoidInvertsLogitAtBothEnds) {
  for (const double p : {1e-12, 0.01, 0.5, 0.97})
    EXPECT_NEAR(sigmoid(logit(p)), p, 1e-15 + p * 1e-12);
  EXPECT_EQ(sigmoid(1000), 1);
  EXPECT_EQ(sigmoid(-1000), 0);
}

}  // namespace
}  // namespace perception
