#include "libperception/core/math/Chi2.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

struct TableValue {
  int degrees_of_freedom;
  double probability, x;
};

// Upper percentage points of the chi-square distribution (NIST/SEMATECH e-Handbook, 1.3.6.7.4),
// three decimals.
constexpr TableValue kTable[] = {
    {1, 0.90, 2.706},    {1, 0.95, 3.841},     {1, 0.99, 6.635},   {1, 0.999, 10.828},
    {2, 0.90, 4.605},    {2, 0.95, 5.991},     {2, 0.99, 9.210},   {2, 0.999, 13.816},
    {3, 0.95, 7.815},    {3, 0.99, 11.345},    {4, 0.95, 9.488},   {4, 0.99, 13.277},
    {5, 0.99, 15.086},   {10, 0.05, 3.940},    {10, 0.95, 18.307}, {30, 0.95, 43.773},
    {100, 0.05, 77.929}, {100, 0.95, 124.342},
};

TEST(Chi2, AgreesWithTheTable) {
  for (const auto& t : kTable) {
    EXPECT_NEAR(chi2Quantile(t.probability, t.degrees_of_freedom), t.x, 5.1e-4);
    EXPECT_NEAR(chi2Cdf(t.x, t.degrees_of_freedom), t.probability, 1e-4);
  }
}

TEST(Chi2, HasTheClosedFormForTwoDegrees) {
  for (const double p : {1e-9, 0.1, 0.5, 0.99, 1 - 1e-9}) {
    const double expected = -2 * std::log1p(-p);
    EXPECT_NEAR(chi2Quantile(p, 2) / expected, 1, 1e-7) << p;
  }
  for (const double p : {0.01, 0.5, 0.99})
    EXPECT_NEAR(chi2Quantile(p, 2), -2 * std::log1p(-p), 1e-10);
}

TEST(Chi2, QuantileInvertsTheCdf) {
  for (int n = 1; n <= 300; n += 23) {
    for (const double p : {0.001, 0.025, 0.5, 0.975, 0.999})
      EXPECT_NEAR(chi2Cdf(chi2Quantile(p, n), n), p, 1e-10);
  }
}

TEST(Chi2, NothingLiesBelowZero) {
  EXPECT_EQ(chi2Cdf(0, 3), 0);
  EXPECT_EQ(chi2Cdf(-1, 3), 0);
}

}  // namespace
}  // namespace perception
