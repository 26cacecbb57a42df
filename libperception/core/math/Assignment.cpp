#include "libperception/core/math/Assignment.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace perception {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

void AssignmentSolver::begin(int columns) {
  columns_ = columns;
  options_.clear();
  first_.assign(1, 0);
  reach_.clear(), touched_.clear();  // of an earlier problem
}

void AssignmentSolver::clearReach() {
  for (const int c : touched_) reach_[at(c)] = {kInfinity, kNone, false};
  touched_.clear();
  sink_ = {kInfinity, kNone, false};
  sink_column_ = -1;
}

void AssignmentSolver::reach(int column, double distance, int from) {
  Reach& r = reach_[at(column)];
  if (r.done || distance >= r.distance) return;
  if (r.from == kNone) touched_.push_back(column);
  r.distance = distance;
  r.from = from;
}

int AssignmentSolver::nearestOpen() const {
  int nearest = -1;
  double least = kInfinity;
  for (const int c : touched_) {
    const Reach& r = reach_[at(c)];
    // Ties: the lowest column, independent of the order of visits.
    if (!r.done && (r.distance < least || (r.distance == least && c < nearest)))
      least = r.distance, nearest = c;
  }
  return nearest;
}

AssignmentNode AssignmentSolver::solve() {
  AssignmentNode node;
  node.column.assign(at(rows()), -1);
  node.u.assign(at(rows()), 0);
  node.v.assign(at(columns_), 0);
  row_of_.assign(at(columns_), -1);
  reach_.assign(at(columns_), {kInfinity, kNone, false});
  touched_.clear();
  std::vector<int> tree;  // columns whose shortest path is known
  for (int start = 0; start < rows(); ++start) {
    clearReach();
    tree.clear();
    int row = start, next = -1;
    double length = 0;
    for (;;) {
      for (int i = first_[at(row)]; i < first_[at(row) + 1]; ++i) {
        const Option& o = options_[at(i)];
        reach(o.column, length + (o.cost - node.v[at(o.column)]) - node.u[at(row)], row);
      }
      next = nearestOpen();  // always exists: at least the row's own column
      length = reach_[at(next)].distance;
      reach_[at(next)].done = true;
      if (row_of_[at(next)] < 0) break;
      tree.push_back(next);
      row = row_of_[at(next)];
    }
    node.u[at(start)] += length;
    for (const int c : tree) {
      const double slack = length - reach_[at(c)].distance;
      node.u[at(row_of_[at(c)])] += slack;
      node.v[at(c)] -= slack;
    }
    for (int c = next;;) {
      const int r = reach_[at(c)].from;
      const int handed_on = node.column[at(r)];
      node.column[at(r)] = c;
      row_of_[at(c)] = r;
      if (r == start) break;
      c = handed_on;
    }
  }
  for (int r = 0; r < rows(); ++r) {
    for (int i = first_[at(r)]; i < first_[at(r) + 1]; ++i)
      if (options_[at(i)].column == node.column[at(r)]) node.cost += options_[at(i)].cost;
  }
  return node;
}

void AssignmentSolver::reachSink(double distance, int from_column, int from_row) {
  if (sink_.done || distance >= sink_.distance) return;
  sink_.distance = distance;
  sink_.from = from_row;
  sink_column_ = from_column;
}

// Relaxes all options of the row except its present column and, at the start of the path, forbidden
// ones.
void AssignmentSolver::relax(const AssignmentNode& node, int row, double length) {
  const int present = node.column[at(row)];
  for (int i = first_[at(row)]; i < first_[at(row) + 1]; ++i) {
    const Option& o = options_[at(i)];
    if (o.column == present || blocked_[at(o.column)]) continue;
    const double reduced = o.cost - node.u[at(row)] - node.v[at(o.column)];
    reach(o.column, length + std::max(0.0, reduced), row);
  }
}

// Any assigned column may become free at the cost of its dual variable.
void AssignmentSolver::relaxFromSink(const AssignmentNode& node, int row) {
  for (int r = row; r < rows(); ++r) {
    const int c = node.column[at(r)];
    reach(c, sink_.distance + std::max(0.0, -node.v[at(c)]), kSink);
  }
}

// A unit flow from the row back to its former column, possibly through the sink of free columns.
// All reduced costs are non-negative, so one search is enough.
bool AssignmentSolver::solveChild(const AssignmentNode& node, int row, double limit,
                                  AssignmentNode& child) {
  const double allowed = limit - node.cost;
  row_of_.assign(at(columns_), -1);
  blocked_.assign(at(columns_), 0);
  for (int r = 0; r < rows(); ++r) {
    row_of_[at(node.column[at(r)])] = r;
    if (r < row) blocked_[at(node.column[at(r)])] = 1;
  }
  if (row == node.fixed)
    for (const int c : node.forbidden) blocked_[at(c)] += 2;
  reach_.resize(at(columns_), {kInfinity, kNone, false});
  clearReach();
  relax(node, row, 0);
  if (row == node.fixed)
    for (const int c : node.forbidden) blocked_[at(c)] = static_cast<char>(blocked_[at(c)] & 1);
  const int target = node.column[at(row)];
  double length = 0;
  for (;;) {
    const int next = nearestOpen();
    const double nearest = next < 0 ? kInfinity : reach_[at(next)].distance;
    if (!sink_.done && sink_.distance < kInfinity && sink_.distance <= nearest) {
      if (sink_.distance > allowed) return false;
      sink_.done = true;
      relaxFromSink(node, row);
      continue;
    }
    if (next < 0 || nearest > allowed) return false;
    length = nearest;
    reach_[at(next)].done = true;
    if (next == target) break;
    const int owner = row_of_[at(next)];
    if (owner < 0) {
      reachSink(length + std::max(0.0, node.v[at(next)]), next, reach_[at(next)].from);
    } else {
      relax(node, owner, length);
    }
  }
  augment(node, row, target, child);
  child.cost = node.cost + length;
  // Updates the dual variables of nodes nearer than the target; that of the sink stays zero.
  const double sink = length - std::min(sink_.distance, length);
  child.u = node.u;
  child.v = node.v;
  for (int r = row; r < rows(); ++r) {
    const double d = r == row ? 0 : reach_[at(node.column[at(r)])].distance;
    child.u[at(r)] += length - std::min(d, length) - sink;
  }
  for (int c = 0; c < columns_; ++c) {
    if (!blocked_[at(c)])
      child.v[at(c)] += sink - (length - std::min(reach_[at(c)].distance, length));
  }
  child.fixed = row;
  child.forbidden.clear();
  if (row == node.fixed) child.forbidden = node.forbidden;
  child.forbidden.push_back(target);
  return true;
}

// Augments along the path: every row on it takes the next column; the column after the sink becomes
// free.
void AssignmentSolver::augment(const AssignmentNode& node, int row, int target,
                               AssignmentNode& child) const {
  child.column = node.column;
  for (int c = target;;) {
    int r = reach_[at(c)].from;
    if (r == kSink) {
      c = sink_column_;
      r = sink_.from;
    }
    child.column[at(r)] = c;
    if (r == row) return;
    c = node.column[at(r)];
  }
}

std::vector<int> optimalAssignment(const Eigen::MatrixXd& cost) {
  assert(cost.allFinite());
  const bool is_wide = cost.rows() <= cost.cols();  // every row then finds a column of its own
  const Eigen::Index rows = std::min(cost.rows(), cost.cols());
  const Eigen::Index columns = std::max(cost.rows(), cost.cols());
  AssignmentSolver solver;
  solver.begin(static_cast<int>(columns));
  for (Eigen::Index r = 0; r < rows; ++r) {
    for (Eigen::Index c = 0; c < columns; ++c)
      solver.addOption(static_cast<int>(c), is_wide ? cost(r, c) : cost(c, r));
    solver.endRow();
  }
  std::vector<int> column = solver.solve().column;
  if (is_wide) return column;
  std::vector<int> of_row(static_cast<std::size_t>(cost.rows()), -1);
  for (std::size_t i = 0; i < column.size(); ++i) of_row[at(column[i])] = static_cast<int>(i);
  return of_row;
}

}  // namespace perception
