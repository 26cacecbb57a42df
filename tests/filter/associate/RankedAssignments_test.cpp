#include "libperception/filter/associate/RankedAssignments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

AssignmentProblem randomProblem(int rows, int columns, double density, Rng& rng) {
  AssignmentProblem p;
  p.columns = columns;
  p.rows.resize(static_cast<std::size_t>(rows));
  for (auto& row : p.rows) {
    for (int c = 0; c < columns; ++c) {
      if (rng.uniform() < density) row.push_back({c, rng.normal(0, 3)});
    }
  }
  return p;
}

/// Every assignment, best first.
std::vector<double> allWeights(const AssignmentProblem& p) {
  std::vector<double> out;
  std::vector<char> used(static_cast<std::size_t>(p.columns), 0);
  std::function<void(std::size_t, double)> from = [&](std::size_t r, double weight) {
    if (r == p.rows.size()) {
      out.push_back(weight);
      return;
    }
    from(r + 1, weight);
    for (const auto& o : p.rows[r]) {
      char& u = used[static_cast<std::size_t>(o.column)];
      if (u) continue;
      u = 1;
      from(r + 1, weight + o.gain);
      u = 0;
    }
  };
  from(0, 0);
  std::sort(out.rbegin(), out.rend());
  return out;
}

double weightOf(const AssignmentProblem& p, const RankedAssignment& a) {
  double sum = 0;
  std::vector<int> used;
  for (std::size_t r = 0; r < p.rows.size(); ++r) {
    if (a.column[r] == RankedAssignment::kNothing) continue;
    EXPECT_EQ(std::count(used.begin(), used.end(), a.column[r]), 0) << "a column taken twice";
    used.push_back(a.column[r]);
    const auto o = std::find_if(p.rows[r].begin(), p.rows[r].end(),
                                [&](const auto& x) { return x.column == a.column[r]; });
    EXPECT_NE(o, p.rows[r].end()) << "not an option";
    if (o != p.rows[r].end()) sum += o->gain;
  }
  return sum;
}

TEST(RankedAssignments, AreThoseOfBruteForceInOrder) {
  Rng rng({5, 0, 0, 0});
  for (int trial = 0; trial < 300; ++trial) {
    const int rows = 1 + static_cast<int>(rng.below(5)), columns = static_cast<int>(rng.below(6));
    const auto p = randomProblem(rows, columns, rng.uniform(0.1, 1), rng);
    const auto truth = allWeights(p);
    const std::size_t k = 1 + rng.below(30);
    const auto ranked = AssignmentRanking(p).rank(k, 1e9);
    ASSERT_EQ(ranked.size(), std::min(k, truth.size()));
    for (std::size_t i = 0; i < ranked.size(); ++i) {
      ASSERT_NEAR(ranked[i].log_weight, truth[i], 1e-9) << "trial " << trial << ", rank " << i;
      ASSERT_NEAR(weightOf(p, ranked[i]), truth[i], 1e-9);
    }
  }
}

TEST(RankedAssignments, AreAllDifferent) {
  Rng rng({6, 0, 0, 0});
  const auto p = randomProblem(6, 6, 0.8, rng);
  const auto ranked = AssignmentRanking(p).rank(200, 1e9);
  ASSERT_EQ(ranked.size(), 200u);
  std::vector<std::vector<int>> columns;
  for (const auto& a : ranked) columns.push_back(a.column);
  std::sort(columns.begin(), columns.end());
  EXPECT_EQ(std::unique(columns.begin(), columns.end()), columns.end());
}

TEST(RankedAssignments, LeaveOutWhatIsFarLighterThanTheBest) {
  Rng rng({7, 0, 0, 0});
  const auto p = randomProblem(5, 5, 0.7, rng);
  const auto truth = allWeights(p);
  const auto expected = static_cast<std::size_t>(
      std::count_if(truth.begin(), truth.end(), [&](double w) { return w >= truth[0] - 3; }));
  EXPECT_EQ(AssignmentRanking(p).rank(100000, 3).size(), expected);
}

TEST(RankedAssignments, OfNoRowsAreOne) {
  const auto ranked = AssignmentRanking(AssignmentProblem()).rank(5, 10);
  ASSERT_EQ(ranked.size(), 1u);
  EXPECT_EQ(ranked[0].log_weight, 0);
}

}  // namespace
}  // namespace perception
