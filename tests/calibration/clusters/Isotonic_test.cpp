#include "libperception/calibration/clusters/Isotonic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

using Values = std::vector<double>;

std::vector<Knot> isotonic(const Values& values, const std::vector<bool>& is_class) {
  return perception::isotonic(values, is_class, Values(values.size(), 1.0));
}

void expectKnots(const std::vector<Knot>& knots, const std::vector<Knot>& expected) {
  ASSERT_EQ(knots.size(), expected.size());
  for (std::size_t i = 0; i < knots.size(); ++i) {
    EXPECT_EQ(knots[i].raw, expected[i].raw) << i;
    EXPECT_NEAR(knots[i].calibrated, expected[i].calibrated, 1e-15) << i;
  }
}

TEST(Isotonic, PoolsAdjacentViolators) {
  // By hand: 0 | 1 0 1 0 becomes 1/2, as 1 0 and 1 0 are equal | 1.
  expectKnots(isotonic({0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, {false, true, false, true, false, true}),
              {{0.1, 0.002}, {0.2, 0.5}, {0.5, 0.5}, {0.6, 0.995}});
}

TEST(Isotonic, DoesNotDependOnTheOrderOfTheSamples) {
  expectKnots(isotonic({0.6, 0.3, 0.1, 0.5, 0.2, 0.4}, {true, false, false, false, true, true}),
              {{0.1, 0.002}, {0.2, 0.5}, {0.5, 0.5}, {0.6, 0.995}});
}

TEST(Isotonic, TakesEqualValuesAsOne) {
  expectKnots(isotonic({0.1, 0.1, 0.1, 0.1, 0.7, 0.7}, {true, false, false, false, true, false}),
              {{0.1, 0.25}, {0.7, 0.5}});
}

TEST(Isotonic, Weighs) {
  expectKnots(perception::isotonic({0.1, 0.2, 0.3}, {true, false, true}, {1, 3, 0}),
              {{0.1, 0.25}, {0.2, 0.25}});
}

TEST(Isotonic, IsMonotoneOfFewKnotsAndCloseToTheTruth) {
  Rng rng(RngKey{1, 0, 0, 11});
  Values values;
  std::vector<bool> is_class;
  for (int i = 0; i < 200000; ++i) {
    values.push_back(rng.uniform());
    is_class.push_back(rng.uniform() < values.back() * values.back());
  }
  const auto knots = isotonic(values, is_class);
  EXPECT_LE(knots.size(), 64u);
  EXPECT_GE(knots.size(), 30u);
  for (std::size_t i = 1; i < knots.size(); ++i) {
    EXPECT_GT(knots[i].raw, knots[i - 1].raw);
    EXPECT_GE(knots[i].calibrated, knots[i - 1].calibrated);
  }
  const Calibration map{knots};
  for (double p = 0.05; p < 1; p += 0.05) EXPECT_NEAR(map(p), p * p, 0.03) << p;
}

TEST(Isotonic, IsNeverCertain) {
  expectKnots(isotonic({0.1, 0.2}, {false, false}), {{0.1, 0.002}, {0.2, 0.002}});
  expectKnots(isotonic({0.1, 0.2}, {true, true}), {{0.1, 0.995}, {0.2, 0.995}});
}

TEST(Isotonic, OfNothingIsEmpty) {
  EXPECT_TRUE(isotonic({}, {}).empty());
  EXPECT_THROW(isotonic({0.5}, {}), Error);
}

}  // namespace
}  // namespace perception
