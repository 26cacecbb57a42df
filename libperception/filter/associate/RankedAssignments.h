#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/math/Assignment.h"

namespace perception {

/// Assignment of each row to one column or to none; no column is used twice. In a scan, rows are
/// measurements, columns are tracks, and none means a newborn or clutter.
struct AssignmentProblem {
  struct Option {
    int column = 0;
    double gain = 0;  ///< log weight of the pair relative to an unassigned row
  };
  int columns = 0;
  std::vector<std::vector<Option>> rows;
};

/// One feasible assignment.
struct RankedAssignment {
  static constexpr int kNothing = -1;
  std::vector<int> column;  ///< by row; kNothing: unassigned
  double log_weight = 0;    ///< sum of the gains
};

/// An assignment problem with its best assignment.
class AssignmentRanking {
 public:
  explicit AssignmentRanking(AssignmentProblem problem);

  const RankedAssignment& best() const { return best_; }
  /// The exact `k` assignments of largest weight, best() first. Options whose reduced cost in it
  /// exceeds `span` are pruned; the remaining independent subproblems are ranked separately by
  /// Murty's partition (K. G. Murty, "An Algorithm for Ranking all the Assignments in Order of
  /// Increasing Cost", Operations Research 16, 1968) and their lists merged. Assignments whose log
  /// weight is lower than the best by more than `span` may be omitted. The order of equal weights
  /// is deterministic.
  std::vector<RankedAssignment> rank(std::size_t k, double span) const;

 private:
  AssignmentProblem problem_;
  RankedAssignment best_;
  AssignmentNode root_;
};

}  // namespace perception
