#include "libperception/core/Assignment.h"

#include <cassert>
#include <limits>

namespace perception {
namespace {

// The Hungarian method for at most as many rows as columns. Rows enter one by one; each is joined
// by the cheapest alternating path (Dijkstra over columns) in costs reduced by the potentials,
// which keep all reduced costs >= 0 and those of the pairs found so far at 0.
class RowByRow {
 public:
  explicit RowByRow(const Eigen::MatrixXd& cost)
      : cost_(cost),
        row_potential_(Eigen::VectorXd::Zero(cost.rows())),
        column_potential_(Eigen::VectorXd::Zero(cost.cols())),
        row_of_column_(static_cast<std::size_t>(cost.cols()), -1) {}

  std::vector<int> solve() {
    for (Eigen::Index row = 0; row < cost_.rows(); ++row) addRow(row);
    std::vector<int> column_of_row(static_cast<std::size_t>(cost_.rows()), -1);
    for (std::size_t c = 0; c < row_of_column_.size(); ++c) {
      if (row_of_column_[c] >= 0)
        column_of_row[static_cast<std::size_t>(row_of_column_[c])] = static_cast<int>(c);
    }
    return column_of_row;
  }

 private:
  int& rowOf(Eigen::Index column) { return row_of_column_[static_cast<std::size_t>(column)]; }

  void addRow(const Eigen::Index new_row) {
    const Eigen::Index columns = cost_.cols();
    constexpr double kFar = std::numeric_limits<double>::infinity();
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(columns, kFar);  // from new_row
    std::vector<Eigen::Index> previous(static_cast<std::size_t>(columns),
                                       -1);  // column before on the path
    std::vector<bool> done(static_cast<std::size_t>(columns), false);
    Eigen::Index row = new_row, last = -1;
    double reached = 0;
    for (;;) {
      Eigen::Index nearest = -1;
      for (Eigen::Index c = 0; c < columns; ++c) {
        if (done[static_cast<std::size_t>(c)]) continue;
        const double via = reached + cost_(row, c) - row_potential_(row) - column_potential_(c);
        if (via < distance(c)) {
          distance(c) = via;
          previous[static_cast<std::size_t>(c)] = last;
        }
        if (nearest < 0 || distance(c) < distance(nearest)) nearest = c;
      }
      reached = distance(nearest);
      last = nearest;
      if (rowOf(nearest) < 0) break;  // a free column: the path ends
      done[static_cast<std::size_t>(nearest)] = true;
      row = rowOf(nearest);
    }
    row_potential_(new_row) += reached;
    for (Eigen::Index c = 0; c < columns; ++c) {
      if (!done[static_cast<std::size_t>(c)]) continue;
      column_potential_(c) -= reached - distance(c);
      row_potential_(rowOf(c)) += reached - distance(c);
    }
    for (Eigen::Index c = last; c >= 0;) {  // flip the pairs along the path
      const Eigen::Index before = previous[static_cast<std::size_t>(c)];
      rowOf(c) = before < 0 ? static_cast<int>(new_row) : rowOf(before);
      c = before;
    }
  }

  const Eigen::MatrixXd& cost_;
  Eigen::VectorXd row_potential_, column_potential_;
  std::vector<int> row_of_column_;
};

}  // namespace

std::vector<int> optimalAssignment(const Eigen::MatrixXd& cost) {
  assert(cost.allFinite());
  if (cost.rows() <= cost.cols()) return RowByRow(cost).solve();
  const Eigen::MatrixXd transposed = cost.transpose();
  const std::vector<int> row_of_column = RowByRow(transposed).solve();
  std::vector<int> column_of_row(static_cast<std::size_t>(cost.rows()), -1);
  for (std::size_t c = 0; c < row_of_column.size(); ++c) {
    column_of_row[static_cast<std::size_t>(row_of_column[c])] = static_cast<int>(c);
  }
  return column_of_row;
}

}  // namespace perception
