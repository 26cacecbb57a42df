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

/// Rows that compete for columns, directly or through others: by row the first row of its group.
std::vector<int> groupsOf(const AssignmentProblem& problem) {
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
        const int one = find(o), other = find(static_cast<int>(r));
        parent[static_cast<std::size_t>(std::max(one, other))] = std::min(one, other);
      }
    }
  }
  for (std::size_t r = 0; r < n; ++r) parent[r] = find(static_cast<int>(r));
  return parent;
}

/// The best assignments of several rows that compete; columns as in the problem.
std::vector<RankedAssignment> rankRows(const AssignmentProblem& problem,
                                       const std::vector<int>& rows, std::size_t k, double span) {
  std::vector<int> columns;
  for (const int r : rows)
    for (const auto& option : problem.rows[static_cast<std::size_t>(r)])
      columns.push_back(option.column);
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  CostMatrix m;
  m.rows = static_cast<int>(rows.size());
  m.columns = static_cast<int>(columns.size());
  m.cost.assign(static_cast<std::size_t>(m.rows) * static_cast<std::size_t>(m.width()), kForbidden);
  for (int r = 0; r < m.rows; ++r) {
    const int row = rows[static_cast<std::size_t>(r)];
    for (const auto& o : problem.rows[static_cast<std::size_t>(row)]) {
      const auto c = std::lower_bound(columns.begin(), columns.end(), o.column);
      m.at(r, static_cast<int>(c - columns.begin())) = -o.gain;
    }
    m.at(r, m.columns + r) = 0;
  }
  auto out = rankPart(m, k, span);
  for (auto& a : out)
    for (int& c : a.column)
      if (c != kNothing) c = columns[static_cast<std::size_t>(c)];
  return out;
}

/// What differs from the best assignment: one row's column, or the choice of a group of rows.
struct Change {
  int group;  // index into the ranked groups; -1: a row alone
  int row, choice;
};

/// An assignment as its differences from the best, and what they cost.
struct Combination {
  double loss = 0;
  std::vector<Change> changes;
};

/// An alternative of one part and its loss against the part's best.
struct Alternative {
  double loss;
  Change change;
};

/// The combinations with one more part whose alternatives are sorted by loss; the best `k` of them.
void join(const std::vector<Alternative>& alternatives, std::size_t k, double span,
          std::vector<Combination>& combinations) {
  std::vector<Combination> more;
  const std::size_t before = combinations.size();
  for (std::size_t i = 0; i < before; ++i) {
    for (const Alternative& a : alternatives) {
      const double loss = combinations[i].loss + a.loss;
      const bool full = before >= k && loss >= combinations.back().loss;
      if (loss > span || full) break;  // later ones cost more
      more.push_back(combinations[i]);
      more.back().loss = loss;
      more.back().changes.push_back(a.change);
    }
  }
  if (more.empty()) return;
  for (auto& c : more) combinations.push_back(std::move(c));
  std::stable_sort(combinations.begin(), combinations.end(),
                   [](const auto& x, const auto& y) { return x.loss < y.loss; });
  if (combinations.size() > k) combinations.resize(k);
}

}  // namespace

std::vector<RankedAssignment> rankedAssignments(const AssignmentProblem& problem, std::size_t k,
                                                double span) {
  const std::size_t n = problem.rows.size();
  const std::vector<int> group_of = groupsOf(problem);
  std::vector<std::vector<int>> members(n);  // of groups of two rows and more, by first row
  for (std::size_t r = 0; r < n; ++r) {
    const auto first = static_cast<std::size_t>(group_of[r]);
    if (first == r) continue;
    if (members[first].empty()) members[first].push_back(group_of[r]);
    members[first].push_back(static_cast<int>(r));
  }

  RankedAssignment best;
  best.column.assign(n, kNothing);
  std::vector<std::vector<RankedAssignment>> groups;
  std::vector<Combination> combinations(1);
  std::vector<Alternative> alternatives;
  for (std::size_t r = 0; r < n; ++r) {
    if (group_of[r] != static_cast<int>(r)) continue;
    const int row = static_cast<int>(r);
    alternatives.clear();
    if (members[r].empty()) {  // alone: every choice is free
      double gain = 0;
      for (const auto& o : problem.rows[r]) {
        if (o.gain > gain) gain = o.gain, best.column[r] = o.column;
      }
      if (best.column[r] != kNothing) alternatives.push_back({gain, {-1, row, kNothing}});
      for (const auto& o : problem.rows[r]) {
        if (o.column != best.column[r])
          alternatives.push_back({gain - o.gain, {-1, row, o.column}});
      }
      best.log_weight += gain;
      std::stable_sort(alternatives.begin(), alternatives.end(),
                       [](const auto& x, const auto& y) { return x.loss < y.loss; });
    } else {
      auto ranked = rankRows(problem, members[r], k, span);
      for (std::size_t i = 0; i < members[r].size(); ++i)
        best.column[static_cast<std::size_t>(members[r][i])] = ranked[0].column[i];
      best.log_weight += ranked[0].log_weight;
      for (std::size_t c = 1; c < ranked.size(); ++c) {
        alternatives.push_back({ranked[0].log_weight - ranked[c].log_weight,
                                {static_cast<int>(groups.size()), row, static_cast<int>(c)}});
      }
      groups.push_back(std::move(ranked));
    }
    join(alternatives, k, span, combinations);
  }

  std::vector<RankedAssignment> out;
  out.reserve(combinations.size());
  for (const Combination& c : combinations) {
    out.push_back(best);
    out.back().log_weight -= c.loss;
    for (const Change& change : c.changes) {
      if (change.group < 0) {
        out.back().column[static_cast<std::size_t>(change.row)] = change.choice;
        continue;
      }
      const auto& chosen =
          groups[static_cast<std::size_t>(change.group)][static_cast<std::size_t>(change.choice)];
      const auto& rows = members[static_cast<std::size_t>(change.row)];
      for (std::size_t i = 0; i < rows.size(); ++i)
        out.back().column[static_cast<std::size_t>(rows[i])] = chosen.column[i];
    }
  }
  return out;
}

}  // namespace perception
