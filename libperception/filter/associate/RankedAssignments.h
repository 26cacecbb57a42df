#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/Assignment.h"

namespace perception {

/// Rows that each take one column of their own choice or nothing; no column is taken twice. In a
/// scan rows are measurements, columns tracks, and nothing means a newborn object or clutter.
struct AssignmentProblem {
  struct Option {
    int column = 0;
    double gain = 0;  ///< log weight of row and column together, against the row taking nothing
  };
  int columns = 0;
  std::vector<std::vector<Option>> rows;
};

/// One way to fill all rows.
struct RankedAssignment {
  static constexpr int kNothing = -1;
  std::vector<int> column;  ///< by row, or kNothing
  double log_weight = 0;    ///< sum of the gains
};

/// A problem with its likeliest assignment.
class AssignmentRanking {
 public:
  explicit AssignmentRanking(AssignmentProblem problem);

  const RankedAssignment& best() const { return best_; }
  /// As rankedAssignments(); the first is best().
  std::vector<RankedAssignment> rank(std::size_t k, double span) const;

 private:
  AssignmentProblem problem_;
  RankedAssignment best_;
  AssignmentNode root_;
};

/// The `k` assignments of largest weight, best first, exactly: choices that cost more than `span`
/// whatever the rest does are left out (the best assignment's dual variables tell), the independent
/// parts that remain are ranked apart (Murty's partition, K. G. Murty, "An Algorithm for Ranking
/// all the Assignments in Order of Increasing Cost", Operations Research 16, 1968) and their lists
/// joined. Those lighter than the best by more than `span` in log weight may be left out. Equal
/// weights come in an order that depends on the arguments alone.
std::vector<RankedAssignment> rankedAssignments(const AssignmentProblem& problem, std::size_t k,
                                                double span);

}  // namespace perception
