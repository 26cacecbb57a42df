#include "libperception/core/math/Assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

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

TEST(AssignmentSolver, SolvesASmallerProblemAfterALargerOne) {
  AssignmentSolver reused;
  for (const int size : {9, 3, 6, 1}) {
    AssignmentSolver fresh;
    for (AssignmentSolver* solver : {&reused, &fresh}) {
      solver->begin(size + 1);
      for (int r = 0; r < size; ++r) {
        for (int c = 0; c <= size; ++c) solver->addOption(c, (3 * r + 5 * c + size) % 7);
        solver->endRow();
      }
    }
    const AssignmentNode one = reused.solve(), other = fresh.solve();
    EXPECT_EQ(one.cost, other.cost);
    EXPECT_EQ(one.column, other.column);
    AssignmentNode next, expected;
    ASSERT_TRUE(fresh.solveChild(other, 0, 1e3, expected));
    ASSERT_TRUE(reused.solveChild(one, 0, 1e3, next));
    EXPECT_EQ(next.cost, expected.cost);
    EXPECT_EQ(next.column, expected.column);
  }
}

TEST(AssignmentSolver, RanksASmallerProblemAfterALargerOneWasNotSolved) {
  AssignmentSolver solver;
  const auto build = [](AssignmentSolver& s, int size) {
    s.begin(size + 1);
    for (int r = 0; r < size; ++r) {
      for (int c = 0; c <= size; ++c) s.addOption(c, r == c ? 0 : 1);
      s.endRow();
    }
  };
  for (const int size : {8, 2}) {
    AssignmentSolver fresh;
    build(fresh, size), build(solver, size);
    const AssignmentNode best = fresh.solve();
    AssignmentNode child;
    ASSERT_TRUE(solver.solveChild(best, 0, 10, child));
    EXPECT_EQ(child.cost, 1);
  }
}

TEST(Assignment, OfNothingIsEmpty) {
  EXPECT_TRUE(optimalAssignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(optimalAssignment(Eigen::MatrixXd(2, 0)), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace perception
