#include "libperception/filter/RankedAssignments.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

namespace perception {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::infinity();
constexpr int kNothing = RankedAssignment::kNothing;

/// Costs (negative gains) of one connected part: rows x (columns + rows), the last ones being each
/// row's "nothing".
struct CostMatrix {
  int rows = 0, columns = 0;  // columns: of tracks
  std::vector<double> cost;   // row by row, width() wide

  int width() const { return columns + rows; }
  double& at(int r, int c) {
    return cost[static_cast<std::size_t>(r) * static_cast<std::size_t>(width()) +
                static_cast<std::size_t>(c)];
  }
  double at(int r, int c) const { return const_cast<CostMatrix*>(this)->at(r, c); }
};

struct Solution {
  std::vector<int> column;  // by row, in 0..width()
  double cost = kForbidden;
};

/// Successive shortest augmenting paths with potentials (Jonker and Volgenant 1987 in its plain
/// form): one path a row, O(rows^2 width).
Solution solve(const CostMatrix& m) {
  const int n = m.rows, w = m.width();
  std::vector<double> u(static_cast<std::size_t>(n), 0), v(static_cast<std::size_t>(w), 0);
  std::vector<int> row_of(static_cast<std::size_t>(w), -1), from(static_cast<std::size_t>(w));
  std::vector<double> distance(static_cast<std::size_t>(w));
  std::vector<char> done(static_cast<std::size_t>(w));
  for (int start = 0; start < n; ++start) {
    std::fill(distance.begin(), distance.end(), kForbidden);
    std::fill(done.begin(), done.end(), 0);
    std::fill(from.begin(), from.end(), -1);
    int row = start, reached = -1;
    double length = 0;
    std::vector<int> tree;  // columns whose shortest path is known
    while (reached < 0) {
      int next = -1;
      double least = kForbidden;
      for (int c = 0; c < w; ++c) {
        const auto i = static_cast<std::size_t>(c);
        if (done[i]) continue;
        const double reduced = length + m.at(row, c) - u[static_cast<std::size_t>(row)] - v[i];
        if (reduced < distance[i]) distance[i] = reduced, from[i] = row;
        if (distance[i] < least) least = distance[i], next = c;
      }
      if (next < 0) return {};  // this row has no free choice left
      length = least;
      done[static_cast<std::size_t>(next)] = 1;
      if (row_of[static_cast<std::size_t>(next)] < 0) {
        reached = next;
      } else {
        tree.push_back(next);
        row = row_of[static_cast<std::size_t>(next)];
      }
    }
    u[static_cast<std::size_t>(start)] += length;
    for (const int c : tree) {
      const auto i = static_cast<std::size_t>(c);
      const double slack = length - distance[i];
      u[static_cast<std::size_t>(row_of[i])] += slack;
      v[i] -= slack;
    }
    for (int c = reached; c >= 0;) {
      const int r = from[static_cast<std::size_t>(c)];
      row_of[static_cast<std::size_t>(c)] = r;
      // The column that r held before is the one to hand on.
      int previous = -1;
      for (const int t : tree) {
        if (t != c && row_of[static_cast<std::size_t>(t)] == r) previous = t;
      }
      c = r == start ? -1 : previous;
    }
  }
  Solution s;
  s.column.assign(static_cast<std::size_t>(n), -1);
  s.cost = 0;
  for (int c = 0; c < w; ++c) {
    const int r = row_of[static_cast<std::size_t>(c)];
    if (r < 0) continue;
    s.column[static_cast<std::size_t>(r)] = c;
    s.cost += m.at(r, c);
  }
  return s;
}

/// A set of assignments with the best one of it.
struct Node {
  CostMatrix matrix;
  Solution best;
  int fixed = 0;                             // rows 0..fixed-1 have no choice left
  std::size_t serial = 0;                    // for ties
  bool operator<(const Node& other) const {  // of a heap whose top is the cheapest
    return best.cost != other.best.cost ? best.cost > other.best.cost : serial > other.serial;
  }
};

RankedAssignment toRanked(const Solution& s, int columns) {
  RankedAssignment out;
  out.log_weight = -s.cost;
  for (const int c : s.column) out.column.push_back(c < columns ? c : kNothing);
  return out;
}

/// Murty: take the best assignment of a set, split the rest of the set by the first row in which
/// they differ from it.
std::vector<RankedAssignment> rankPart(const CostMatrix& part, std::size_t k, double span) {
  std::vector<RankedAssignment> out;
  std::priority_queue<Node> open;
  std::size_t serial = 0;
  Node root{part, solve(part), 0, serial++};
  if (root.best.cost == kForbidden) return out;
  const double limit = root.best.cost + span;
  open.push(std::move(root));
  while (!open.empty() && out.size() < k) {
    const Node node = open.top();
    open.pop();
    out.push_back(toRanked(node.best, part.columns));
    CostMatrix rest = node.matrix;
    for (int r = node.fixed; r < part.rows && out.size() < k; ++r) {
      const int taken = node.best.column[static_cast<std::size_t>(r)];
      const double kept = rest.at(r, taken);
      rest.at(r, taken) = kForbidden;
      Solution s = solve(rest);
      if (s.cost <= limit) open.push({rest, std::move(s), r, serial++});
      for (int c = 0; c < part.width(); ++c) rest.at(r, c) = kForbidden;
      for (int other = r + 1; other < part.rows; ++other) rest.at(other, taken) = kForbidden;
      rest.at(r, taken) = kept;
    }
  }
  return out;
}

/// Rows that compete for columns, directly or through others.
struct Part {
  std::vector<int> rows, columns;  // ascending
};

std::vector<Part> independentParts(const AssignmentProblem& problem) {
  const std::size_t n = problem.rows.size();
  std::vector<int> parent(n), owner(static_cast<std::size_t>(problem.columns), -1);
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](int r) {
    while (parent[static_cast<std::size_t>(r)] != r)
      r = parent[static_cast<std::size_t>(r)] =
          parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(r)])];
    return r;
  };
  for (std::size_t r = 0; r < n; ++r) {
    for (const auto& option : problem.rows[r]) {
      int& o = owner[static_cast<std::size_t>(option.column)];
      if (o < 0) {
        o = static_cast<int>(r);
      } else {
        const int a = find(o), b = find(static_cast<int>(r));
        parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
  }
  std::vector<int> number(n, -1);
  std::vector<Part> parts;
  for (std::size_t r = 0; r < n; ++r) {
    const auto root = static_cast<std::size_t>(find(static_cast<int>(r)));
    if (number[root] < 0) number[root] = static_cast<int>(parts.size()), parts.emplace_back();
    parts[static_cast<std::size_t>(number[root])].rows.push_back(static_cast<int>(r));
  }
  for (Part& part : parts) {
    for (const int r : part.rows)
      for (const auto& option : problem.rows[static_cast<std::size_t>(r)])
        part.columns.push_back(option.column);
    std::sort(part.columns.begin(), part.columns.end());
    part.columns.erase(std::unique(part.columns.begin(), part.columns.end()), part.columns.end());
  }
  return parts;
}

/// One row alone: its choices in order.
std::vector<RankedAssignment> rankRow(const std::vector<AssignmentProblem::Option>& options,
                                      std::size_t k, double span) {
  std::vector<RankedAssignment> out{{{kNothing}, 0}};
  for (const auto& o : options) out.push_back({{o.column}, o.gain});
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.log_weight > b.log_weight; });
  std::size_t kept = 1;
  while (kept < std::min(k, out.size()) && out[kept].log_weight >= out.front().log_weight - span)
    ++kept;
  out.resize(kept);
  return out;
}

std::vector<RankedAssignment> rankIn(const AssignmentProblem& problem, const Part& part,
                                     std::size_t k, double span) {
  if (part.rows.size() == 1)
    return rankRow(problem.rows[static_cast<std::size_t>(part.rows[0])], k, span);
  CostMatrix m;
  m.rows = static_cast<int>(part.rows.size());
  m.columns = static_cast<int>(part.columns.size());
  m.cost.assign(static_cast<std::size_t>(m.rows) * static_cast<std::size_t>(m.width()), kForbidden);
  for (int r = 0; r < m.rows; ++r) {
    for (const auto& o :
         problem.rows[static_cast<std::size_t>(part.rows[static_cast<std::size_t>(r)])]) {
      const auto c = std::lower_bound(part.columns.begin(), part.columns.end(), o.column);
      m.at(r, static_cast<int>(c - part.columns.begin())) = -o.gain;
    }
    m.at(r, m.columns + r) = 0;
  }
  auto out = rankPart(m, k, span);
  for (auto& a : out)
    for (int& c : a.column)
      if (c != kNothing) c = part.columns[static_cast<std::size_t>(c)];
  return out;
}

/// The best `k` pairs of two sorted lists: which of either, by weight.
std::vector<std::pair<std::size_t, std::size_t>> bestPairs(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           std::size_t k, double span) {
  struct Pair {
    double weight;
    std::size_t i, j;
    bool operator<(const Pair& o) const {
      if (weight != o.weight) return weight < o.weight;
      return i != o.i ? i > o.i : j > o.j;
    }
  };
  std::priority_queue<Pair> open;
  for (std::size_t i = 0; i < a.size(); ++i) open.push({a[i] + b[0], i, 0});
  std::vector<std::pair<std::size_t, std::size_t>> out;
  while (!open.empty() && out.size() < k) {
    const Pair p = open.top();
    open.pop();
    if (p.weight < a[0] + b[0] - span) break;
    out.push_back({p.i, p.j});
    if (p.j + 1 < b.size()) open.push({a[p.i] + b[p.j + 1], p.i, p.j + 1});
  }
  return out;
}

}  // namespace

std::vector<RankedAssignment> rankedAssignments(const AssignmentProblem& problem, std::size_t k,
                                                double span) {
  RankedAssignment start;
  start.column.assign(problem.rows.size(), kNothing);
  std::vector<RankedAssignment> all{start};
  for (const Part& part : independentParts(problem)) {
    const auto own = rankIn(problem, part, k, span);
    std::vector<double> a, b;
    for (const auto& x : all) a.push_back(x.log_weight);
    for (const auto& x : own) b.push_back(x.log_weight);
    std::vector<RankedAssignment> joined;
    const auto set = [&](RankedAssignment& to, const RankedAssignment& from) {
      for (std::size_t r = 0; r < part.rows.size(); ++r)
        to.column[static_cast<std::size_t>(part.rows[r])] = from.column[r];
      to.log_weight += from.log_weight;
    };
    if (own.size() == 1) {  // the usual case: nothing to choose
      for (auto& x : all) set(x, own[0]);
      continue;
    }
    for (const auto& [i, j] : bestPairs(a, b, k, span)) {
      joined.push_back(all[i]);
      set(joined.back(), own[j]);
    }
    all = std::move(joined);
  }
  return all;
}

}  // namespace perception
