#include "libperception/evaluation/Matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include "libperception/core/Assignment.h"

namespace perception {
namespace {

// The least cost over all assignments of rows to columns (rows <= columns).
double leastCost(const Eigen::MatrixXd& cost) {
  std::vector<int> columns(static_cast<std::size_t>(cost.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  double best = std::numeric_limits<double>::infinity();
  do {
    double sum = 0;
    for (Eigen::Index r = 0; r < cost.rows(); ++r)
      sum += cost(r, columns[static_cast<std::size_t>(r)]);
    best = std::min(best, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return best;
}

TEST(Assignment, HasTheLeastCostOfAllAssignments) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-5, 5);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Index rows = 1 + trial % 5, columns = rows + trial % 3;
    const Eigen::MatrixXd cost =
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); });
    const std::vector<int> a = optimalAssignment(cost);
    double sum = 0;
    std::vector<int> used;
    for (Eigen::Index r = 0; r < rows; ++r) {
      ASSERT_GE(a[static_cast<std::size_t>(r)], 0);
      sum += cost(r, a[static_cast<std::size_t>(r)]);
      used.push_back(a[static_cast<std::size_t>(r)]);
    }
    std::sort(used.begin(), used.end());
    EXPECT_EQ(std::adjacent_find(used.begin(), used.end()), used.end());
    EXPECT_NEAR(sum, leastCost(cost), 1e-9);
    const std::vector<int> t = optimalAssignment(cost.transpose());
    double transposed = 0;
    for (Eigen::Index c = 0; c < columns; ++c) {
      if (t[static_cast<std::size_t>(c)] >= 0)
        transposed += cost(t[static_cast<std::size_t>(c)], c);
    }
    EXPECT_NEAR(transposed, sum, 1e-9);
    EXPECT_EQ(std::count(t.begin(), t.end(), -1), columns - rows);
  }
}

TEST(Assignment, OfNothingIsEmpty) {
  EXPECT_TRUE(optimalAssignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(optimalAssignment(Eigen::MatrixXd(2, 0)), (std::vector<int>{-1, -1}));
}

TEST(Matching, ClosestLetsOneEstimateServeTwoTruths) {
  const std::vector<Vector2> truth = {{0, 0}, {1, 0}}, estimates = {{0.6, 0}};
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kClosest), (std::vector<int>{0, 0}));
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kOneToOne), (std::vector<int>{-1, 0}));
}

TEST(Matching, OneToOnePrefersMorePairsToAShorterOne) {
  // Greedily the pair (1, 0) at 0.1 m would leave truth 0 alone.
  const std::vector<Vector2> truth = {{0, 0}, {1, 0}}, estimates = {{1.1, 0}, {2.5, 0}};
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kOneToOne), (std::vector<int>{0, 1}));
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kClosest), (std::vector<int>{0, 0}));
}

TEST(Matching, ThePairMayBeAsFarApartAsTheToleranceAndNoFarther) {
  for (const Pairing p : {Pairing::kClosest, Pairing::kOneToOne}) {
    EXPECT_EQ(match({{0, 0}}, {{2, 0}}, 2, p), std::vector<int>{0});
    EXPECT_EQ(match({{0, 0}}, {{2.001, 0}}, 2, p), std::vector<int>{-1});
    EXPECT_EQ(match({{0, 0}}, {}, 2, p), std::vector<int>{-1});
    EXPECT_TRUE(match({}, {{0, 0}}, 2, p).empty());
  }
}

TEST(Matching, OneToOneEqualsExhaustiveSearch) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 4);
  const auto draw = [&](std::size_t n) {
    std::vector<Vector2> points(n);
    for (Vector2& p : points) p = {uniform(random), uniform(random)};
    return points;
  };
  for (std::size_t trial = 0; trial < 200; ++trial) {
    const auto truth = draw(1 + trial % 4), estimates = draw(1 + trial % 5);
    // (pairs, -distance), lexicographically the greatest.
    std::pair<int, double> best{0, 0};
    std::vector<bool> used(estimates.size(), false);
    const std::function<void(std::size_t, int, double)> search = [&](std::size_t r, int pairs,
                                                                     double sum) {
      best = std::max(best, {pairs, -sum});
      if (r == truth.size()) return;
      search(r + 1, pairs, sum);
      for (std::size_t c = 0; c < estimates.size(); ++c) {
        const double d = (truth[r] - estimates[c]).norm();
        if (used[c] || d > 2) continue;
        used[c] = true;
        search(r + 1, pairs + 1, sum + d);
        used[c] = false;
      }
    };
    search(0, 0, 0);
    std::pair<int, double> found{0, 0};
    const auto result = match(truth, estimates, 2, Pairing::kOneToOne);
    for (std::size_t r = 0; r < result.size(); ++r) {
      if (result[r] < 0) continue;
      ++found.first;
      found.second -= (truth[r] - estimates[static_cast<std::size_t>(result[r])]).norm();
    }
    EXPECT_EQ(found.first, best.first);
    EXPECT_NEAR(found.second, best.second, 1e-9);
  }
}

}  // namespace
}  // namespace perception
