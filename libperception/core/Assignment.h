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
  int fixed = 0;               ///< rows 0..fixed-1 keep their columns ...
  std::vector<int> forbidden;  ///< ... and row `fixed` must not take these
};

/// Rows that each take one column, none twice, at least cost. Every row has a column of its own as
/// a last resort. Sparse: only the options that there are are looked at.
class AssignmentSolver {
 public:
  struct Option {
    int column;
    double cost;
  };

  /// Starts a problem; rows follow one by one.
  void begin(int columns);
  void addOption(int column, double cost) { options_.push_back({column, cost}); }
  void endRow() { first_.push_back(static_cast<int>(options_.size())); }

  int rows() const { return static_cast<int>(first_.size()) - 1; }
  int columns() const { return columns_; }

  /// The best assignment: successive shortest paths with potentials (Jonker and Volgenant 1987).
  AssignmentNode solve();
  /// The best assignment of the node's set in which row `row` takes another column than now and
  /// those before it keep theirs, from one shortest path (Miller, Stone and Cox 1997). False when
  /// there is none within `limit`.
  bool solveChild(const AssignmentNode& node, int row, double limit, AssignmentNode& child);

 private:
  /// How far a column or the sink of free columns is from the path's start, and from where.
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
  std::vector<int> first_;  // of each row, and the end
  // Of one search:
  std::vector<Reach> reach_;  // by column
  std::vector<int> touched_;  // columns whose distance is known
  std::vector<int> row_of_;   // by column; -1: free
  std::vector<char> blocked_;
  std::vector<char> is_forbidden_;
  Reach sink_{};
  int sink_column_ = -1;  // the free column by which the sink was reached
};

/// The assignment of rows to columns with the smallest sum of costs that pairs min(rows, columns)
/// of them: entry r is the column of row r or -1. Costs are finite; O(n^3).
std::vector<int> optimalAssignment(const Eigen::MatrixXd& cost);

}  // namespace perception
