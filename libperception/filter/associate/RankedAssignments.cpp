#include "libperception/filter/associate/RankedAssignments.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "libperception/filter/associate/RankedSums.h"

namespace perception {
namespace {

constexpr int kNothing = RankedAssignment::kNothing;
constexpr int kNone = -1;  // row
/// Tolerance for rounding errors of the dual variables.
constexpr double kRounding = 1e-9;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The complete problem: columns of tracks first, then one "none" column per row.
AssignmentNode solveWhole(const AssignmentProblem& problem) {
  thread_local AssignmentSolver solver;  // keeps its memory
  const int n = static_cast<int>(problem.rows.size());
  solver.begin(problem.columns + n);
  for (int r = 0; r < n; ++r) {
    for (const auto& o : problem.rows[at(r)]) solver.addOption(o.column, -o.gain);
    solver.addOption(problem.columns + r, 0);
    solver.endRow();
  }
  return solver.solve();
}

using Option = AssignmentProblem::Option;

/// The options of a row.
struct RowOptions {
  const Option *first, *last;
  const Option* begin() const { return first; }
  const Option* end() const { return last; }
};

/// A problem without options that no assignment within a span contains, row after row.
class PrunedProblem {
 public:
  PrunedProblem(const AssignmentProblem& problem, const AssignmentNode& root, double span)
      : columns(problem.columns) {
    end_.reserve(problem.rows.size());
    for (std::size_t r = 0; r < problem.rows.size(); ++r) {
      for (const Option& o : problem.rows[r]) {
        const double reduced = -o.gain - root.u[r] - root.v[at(o.column)];
        if (reduced <= span + kRounding) options_.push_back(o);
      }
      end_.push_back(options_.size());
    }
  }
  std::size_t rows() const { return end_.size(); }
  RowOptions row(std::size_t r) const {
    return {options_.data() + (r == 0 ? 0 : end_[r - 1]), options_.data() + end_[r]};
  }

  int columns;

 private:
  std::vector<Option> options_;
  std::vector<std::size_t> end_;  // of each row
};

/// Rows that compete for columns, directly or through others: by row the first row of its group.
std::vector<int> groupsOf(const PrunedProblem& problem) {
  const std::size_t n = problem.rows();
  std::vector<int> parent(n), owner(at(problem.columns), -1);
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](int r) {
    while (parent[at(r)] != r) r = parent[at(r)] = parent[at(parent[at(r)])];
    return r;
  };
  for (std::size_t r = 0; r < n; ++r) {
    for (const Option& option : problem.row(r)) {
      int& o = owner[at(option.column)];
      if (o < 0) {
        o = static_cast<int>(r);
      } else {
        const int one = find(o), other = find(static_cast<int>(r));
        parent[at(std::max(one, other))] = std::min(one, other);
      }
    }
  }
  for (std::size_t r = 0; r < n; ++r) parent[r] = find(static_cast<int>(r));
  return parent;
}

/// Murty: take the best assignment of a set, partition the rest of the set by the first row that
/// differs from it. All but the first of the best `k` within the limit.
std::vector<AssignmentNode> rankOthers(AssignmentSolver& solver, AssignmentNode root, std::size_t k,
                                       double span) {
  std::vector<AssignmentNode> out;
  std::vector<AssignmentNode>
      open;  // by cost, ties by age; at most as many as can still be returned
  const double limit = root.cost + span;
  AssignmentNode node = std::move(root), child;
  while (out.size() + 1 < k) {
    const std::size_t wanted = k - 1 - out.size();
    for (int r = node.fixed; r < solver.rows(); ++r) {
      const double bound = open.size() < wanted ? limit : std::min(limit, open.back().cost);
      if (!solver.solveChild(node, r, bound, child)) continue;
      const auto place =
          std::upper_bound(open.begin(), open.end(), child.cost,
                           [](double cost, const AssignmentNode& n) { return cost < n.cost; });
      if (open.size() >= wanted && place == open.end()) continue;
      open.insert(place, std::move(child));
      if (open.size() > wanted) open.pop_back();
      child = AssignmentNode();
    }
    if (open.empty()) break;
    node = open.front();
    open.erase(open.begin());
    out.push_back(node);
  }
  return out;
}

/// The alternatives of rows that compete with each other alone.
struct Alternatives {
  std::vector<double> losses;  // ascending
  std::vector<int> columns;    // [alternative][row], of the problem
};

Alternatives rankGroup(const PrunedProblem& problem, const AssignmentNode& whole,
                       const std::vector<int>& rows, std::size_t k, double span) {
  std::vector<int> columns;
  for (const int r : rows)
    for (const Option& option : problem.row(at(r))) columns.push_back(option.column);
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  const int tracks = static_cast<int>(columns.size()), n = static_cast<int>(rows.size());
  const auto own = [&](int column, int row) {
    if (column >= problem.columns) return tracks + row;
    return static_cast<int>(std::lower_bound(columns.begin(), columns.end(), column) -
                            columns.begin());
  };
  thread_local AssignmentSolver solver;  // keeps its memory
  solver.begin(tracks + n);
  AssignmentNode root;
  root.v.resize(at(tracks + n));
  for (int c = 0; c < tracks; ++c) root.v[at(c)] = whole.v[at(columns[at(c)])];
  for (int i = 0; i < n; ++i) {
    const int row = rows[at(i)];
    for (const Option& o : problem.row(at(row))) {
      solver.addOption(own(o.column, i), -o.gain);
      if (whole.column[at(row)] == o.column) root.cost -= o.gain;
    }
    solver.addOption(tracks + i, 0);
    solver.endRow();
    root.column.push_back(own(whole.column[at(row)], i));
    root.u.push_back(whole.u[at(row)]);
    root.v[at(tracks + i)] = whole.v[at(problem.columns + row)];
  }
  const double least = root.cost;
  Alternatives out;
  for (const auto& node : rankOthers(solver, std::move(root), k, span)) {
    out.losses.push_back(node.cost - least);
    for (const int c : node.column) out.columns.push_back(c < tracks ? columns[at(c)] : kNothing);
  }
  return out;
}

/// The alternatives of a row that shares no option with other rows; equal ones in their order.
Alternatives rankAlone(const RowOptions& options, int best, std::size_t k, double span) {
  double gain = 0;
  for (const Option& o : options)
    if (o.column == best) gain = o.gain;
  Alternatives out;
  const auto add = [&out, k, span](int column, double loss) {
    if (loss > span) return;
    const auto place = std::upper_bound(out.losses.begin(), out.losses.end(), loss);
    out.columns.insert(out.columns.begin() + (place - out.losses.begin()), column);
    out.losses.insert(place, loss);
    if (out.losses.size() >= k) out.losses.pop_back(), out.columns.pop_back();
  };
  if (best != kNothing) add(kNothing, gain);
  for (const Option& o : options)
    if (o.column != best) add(o.column, gain - o.gain);
  return out;
}

}  // namespace

AssignmentRanking::AssignmentRanking(AssignmentProblem problem) : problem_(std::move(problem)) {
  if (problem_.rows.size() == 1) {  // no competing row
    best_.column.assign(1, kNothing);
    for (const auto& o : problem_.rows[0]) {
      if (o.gain > best_.log_weight) best_.column[0] = o.column, best_.log_weight = o.gain;
    }
    return;
  }
  root_ = solveWhole(problem_);
  best_.log_weight = -root_.cost;
  best_.column.reserve(root_.column.size());
  for (const int c : root_.column) best_.column.push_back(c < problem_.columns ? c : kNothing);
}

std::vector<RankedAssignment> AssignmentRanking::rank(std::size_t k, double span) const {
  const std::size_t n = problem_.rows.size();
  if (n == 1) {
    std::vector<RankedAssignment> out{best_};
    const auto& row = problem_.rows[0];
    const auto found = rankAlone({row.data(), row.data() + row.size()}, best_.column[0], k, span);
    for (std::size_t a = 0; a < found.losses.size(); ++a)
      out.push_back({{found.columns[a]}, best_.log_weight - found.losses[a]});
    return out;
  }
  const PrunedProblem problem(problem_, root_, span);
  const std::vector<int> group_of = groupsOf(problem);
  std::vector<int> next(n, kNone), last(n);  // row of a row's group, last one of a group so far
  for (std::size_t r = 0; r < n; ++r) {
    const std::size_t group = at(group_of[r]);
    if (group != r) next[at(last[group])] = static_cast<int>(r);
    last[group] = static_cast<int>(r);
  }

  struct Group {
    std::vector<int> rows;
    Alternatives alternatives;
  };
  std::vector<Group> groups;
  RankedSums sums(k);
  for (std::size_t r = 0; r < n; ++r) {
    if (at(group_of[r]) != r) continue;
    Group group;
    for (int row = static_cast<int>(r); row != kNone; row = next[at(row)])
      group.rows.push_back(row);
    group.alternatives = group.rows.size() == 1
                             ? rankAlone(problem.row(r), best_.column[r], k, span)
                             : rankGroup(problem, root_, group.rows, k, span);
    const std::vector<double>& losses = group.alternatives.losses;
    if (losses.empty()) continue;
    sums.join(static_cast<std::uint32_t>(groups.size()), losses.data(), losses.size(), span);
    groups.push_back(std::move(group));
  }

  std::vector<RankedAssignment> out;
  out.reserve(sums.sums().size());
  for (const RankedSums::Sum& sum : sums.sums()) {
    out.push_back(best_);
    out.back().log_weight -= sum.loss;
    sums.forEachChange(sum, [&](std::uint32_t g, std::uint32_t alternative) {
      const std::vector<int>& rows = groups[g].rows;
      const int* columns = &groups[g].alternatives.columns[alternative * rows.size()];
      for (std::size_t i = 0; i < rows.size(); ++i) out.back().column[at(rows[i])] = columns[i];
    });
  }
  return out;
}

}  // namespace perception
