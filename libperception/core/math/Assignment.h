#pragma once
#include <Eigen/Core>
#include <vector>

namespace perception {

/// An assignment of least cost with the dual variables that prove it: cost(r, c) >= u[r] + v[c] for
/// every option, equal for those taken; v <= 0 for taken columns, >= 0 for free ones.
struct AssignmentNode {
  double cost = 0;
  std::vector<int> column;     ///< by row
  std::vector<double> u, v;    ///< by row, by column
  int fixed = 0;               ///< rows 0..fixed-1 are fixed to their columns ...
  std::vector<int> forbidden;  ///< ... and row `fixed` must not be assigned to these
};

/// Sparse linear assignment: each row to one column, no column twice, at minimum cost. Every row
/// needs an option of its own that no other row has, so that a solution exists.
class AssignmentSolver {
 public:
  struct Option {
    int column;
    double cost;
  };

  /// Starts a problem; add the options of each row, then endRow().
  void begin(int columns);
  void addOption(int column, double cost) { options_.push_back({column, cost}); }
  void endRow() { first_.push_back(static_cast<int>(options_.size())); }

  int rows() const { return static_cast<int>(first_.size()) - 1; }
  int columns() const { return columns_; }

  /// The optimal assignment: successive shortest paths with potentials (Jonker and Volgenant 1987).
  AssignmentNode solve();
  /// The optimal assignment of the node's set in which row `row` changes its column and the rows
  /// before it keep theirs, by one shortest path (Miller, Stone and Cox 1997). False when none
  /// costs less than `limit`.
  bool solveChild(const AssignmentNode& node, int row, double limit, AssignmentNode& child);

 private:
  /// Distance of a column, or of the sink of free columns, from the start of the path, and
  /// predecessor.
  struct Reach {
    double distance;
    int from;  // a row, kSink or kNone
    bool done;
  };
  static constexpr int kSink = -1, kNone = -2;

  void clearReach();
  void reach(int column, double distance, int from);
  void reachSink(double distance, int from_column, int from_row);
  void relax(const AssignmentNode& node, int row, double length);
  void relaxFromSink(const AssignmentNode& node, int row);
  int nearestOpen() const;
  void augment(const AssignmentNode& node, int row, int target, AssignmentNode& child) const;

  int columns_ = 0;
  std::vector<Option> options_;
  std::vector<int> first_;  // of each row, and one past the end
  // State of one search:
  std::vector<Reach> reach_;  // by column
  std::vector<int> touched_;  // columns with a finite distance
  std::vector<int> row_of_;   // by column; -1: free
  std::vector<char> blocked_;
  std::vector<char> is_forbidden_;
  Reach sink_{};
  int sink_column_ = -1;  // the free column through which the sink was reached
};

/// The assignment of rows to columns with the smallest sum of costs that pairs min(rows, columns)
/// of them: entry r is the column of row r or -1. Costs are finite; O(n^3).
std::vector<int> optimalAssignment(const Eigen::MatrixXd& cost);

}  // namespace perception
