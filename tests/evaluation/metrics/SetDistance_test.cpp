#include "libperception/evaluation/metrics/SetDistance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace perception {
namespace {

TEST(Gospa, AgreesWithAHandCalculation) {
  // One pair at 1 m, one truth missed, two false: 1 + 2 + 2 * 2 = 7.
  const Gospa g = gospa({{0, 0}, {10, 0}}, {{1, 0}, {30, 0}, {50, 0}}, 2);
  EXPECT_DOUBLE_EQ(g.localization, 1);
  EXPECT_DOUBLE_EQ(g.missed, 2);
  EXPECT_DOUBLE_EQ(g.false_, 4);
  EXPECT_EQ(g.pairs, 1u);
  EXPECT_DOUBLE_EQ(g.value(), std::sqrt(7.0));
}

TEST(Gospa, OfEmptySetsCountsTheOthers) {
  EXPECT_EQ(gospa({}, {}, 2).value(), 0);
  EXPECT_DOUBLE_EQ(gospa({{0, 0}}, {}, 2).value(), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(gospa({}, {{0, 0}, {1, 1}}, 2).value(), 2);
}

TEST(Gospa, APairAtTheCutOffIsAMissedAndAFalseObject) {
  const Gospa g = gospa({{0, 0}}, {{2, 0}}, 2);
  EXPECT_EQ(g.pairs, 0u);
  EXPECT_DOUBLE_EQ(g.missed, 2);
  EXPECT_DOUBLE_EQ(g.false_, 2);
}

TEST(Ospa, AgreesWithAHandCalculation) {
  EXPECT_EQ(ospa({}, {}, 2), 0);
  EXPECT_DOUBLE_EQ(ospa({{0, 0}}, {}, 2), 2);
  EXPECT_DOUBLE_EQ(ospa({{0, 0}, {9, 0}}, {{1, 0}}, 2), std::sqrt((1.0 + 4.0) / 2));
  EXPECT_DOUBLE_EQ(ospa({{0, 0}}, {{5, 0}}, 2), 2);
}

TEST(SetDistances, EqualBruteForceOverAllAssignments) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 5);
  const auto draw = [&](std::size_t n) {
    std::vector<Vector2> points(n);
    for (Vector2& p : points) p = {uniform(random), uniform(random)};
    return points;
  };
  constexpr double kCutoff = 2;
  for (std::size_t trial = 0; trial < 200; ++trial) {
    const auto truth = draw(trial % 5), estimates = draw(trial % 4 + trial % 2);
    std::vector<bool> used(estimates.size(), false);
    double best_gospa = std::numeric_limits<double>::infinity(), best_ospa = best_gospa;
    // Definitions: GOSPA sums d^2 over any partial assignment and c^2 / 2 for all that is left;
    // OSPA pads the smaller set.
    const std::function<void(std::size_t, std::size_t, double, double)> search =
        [&](std::size_t r, std::size_t pairs, double sum, double cut) {
          if (r == truth.size()) {
            const double left = static_cast<double>(truth.size() + estimates.size() - 2 * pairs);
            best_gospa = std::min(best_gospa, sum + kCutoff * kCutoff / 2 * left);
            const std::size_t larger = std::max(truth.size(), estimates.size());
            if (larger > 0) {
              const double padded = cut + kCutoff * kCutoff * static_cast<double>(larger - pairs);
              best_ospa = std::min(best_ospa, padded / static_cast<double>(larger));
            }
            return;
          }
          search(r + 1, pairs, sum, cut);
          for (std::size_t c = 0; c < estimates.size(); ++c) {
            if (used[c]) continue;
            used[c] = true;
            const double square = (truth[r] - estimates[c]).squaredNorm();
            search(r + 1, pairs + 1, sum + square, cut + std::min(square, kCutoff * kCutoff));
            used[c] = false;
          }
        };
    search(0, 0, 0, 0);
    EXPECT_NEAR(gospa(truth, estimates, kCutoff).squared(), best_gospa, 1e-9);
    if (!truth.empty() || !estimates.empty()) {
      EXPECT_NEAR(ospa(truth, estimates, kCutoff), std::sqrt(best_ospa), 1e-9);
    }
  }
}

}  // namespace
}  // namespace perception
