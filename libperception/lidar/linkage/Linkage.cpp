#include "libperception/lidar/linkage/Linkage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "libperception/lidar/linkage/Forest.h"
#include "libperception/lidar/linkage/LinkageCells.h"

namespace perception {

namespace {

/// Whether some point of cell i is within sqrt(threshold2) of some point of cell j.
bool touch(const LinkageCells& cells, std::uint32_t i, std::uint32_t j, float threshold2) {
  const LinkageCells::Box &a = cells.box[i], &b = cells.box[j];
  const auto gap2 = [](float x0, float x1, float y0, float y1, const LinkageCells::Box& box) {
    const float gap_x = std::max({box.x0 - x1, x0 - box.x1, 0.0f}),
                gap_y = std::max({box.y0 - y1, y0 - box.y1, 0.0f});
    return gap_x * gap_x + gap_y * gap_y;
  };
  if (gap2(a.x0, a.x1, a.y0, a.y1, b) > threshold2) return false;
  for (std::uint32_t p = cells.start[i]; p < cells.start[i + 1]; ++p) {
    const float x = cells.points[p].x, y = cells.points[p].y;
    if (gap2(x, x, y, y, b) > threshold2) continue;
    for (std::uint32_t q = cells.start[j]; q < cells.start[j + 1]; ++q) {
      const float dx = x - cells.points[q].x, dy = y - cells.points[q].y;
      if (dx * dx + dy * dy <= threshold2) return true;
    }
  }
  return false;
}

/// Range of cells in this or a following row that may hold points within the threshold of a cell's
/// points.
struct Reach {
  std::int32_t row, first_column, last_column;  ///< relative to the cell
};

/// The ranges in one half-plane about a cell.
std::vector<Reach> reachesOf(double side, double threshold) {
  std::vector<Reach> reaches;
  const auto most = static_cast<std::int32_t>(std::ceil(threshold / side)) + 1;
  for (std::int32_t row = 0; row <= most; ++row) {
    std::int32_t widest = -1;
    for (std::int32_t column = 0; column <= most; ++column) {
      const double gap = std::hypot(std::max(column - 1, 0), std::max(row - 1, 0)) * side;
      if (gap <= threshold * (1 + 1e-6)) widest = column;
    }
    if (widest >= 0) reaches.push_back({row, row == 0 ? 1 : -widest, widest});
  }
  return reaches;
}

/// Neighboring cells of a row in the same set.
struct Run {
  std::uint32_t first, last;  ///< cells
  std::uint32_t set;          ///< root in the forest when the run was made
};

struct Runs {
  Runs(const LinkageCells& cells, const std::vector<std::uint32_t>& set) {
    for (std::size_t r = 0; r + 1 < cells.row_start.size(); ++r) {
      row_start.push_back(runs.size());
      for (std::uint32_t i = cells.row_start[r]; i < cells.row_start[r + 1]; ++i) {
        if (i > cells.row_start[r] && runs.back().set == set[i]) {
          runs.back().last = i;
        } else {
          runs.push_back({i, i, set[i]});
        }
      }
    }
    row_start.push_back(runs.size());
  }
  std::vector<Run> runs;
  std::vector<std::size_t> row_start;  ///< as LinkageCells::row_start
};

/// Whether points of two runs lie within the threshold, looking at cells within reach of each
/// other.
bool touch(const LinkageCells& cells, const Run& a, const Run& b, const Reach& reach,
           float threshold2) {
  std::uint32_t first = b.first;
  for (std::uint32_t i = a.first; i <= a.last; ++i) {
    while (first <= b.last && cells.columns[first] < cells.columns[i] + reach.first_column) ++first;
    for (std::uint32_t j = first;
         j <= b.last && cells.columns[j] <= cells.columns[i] + reach.last_column; ++j)
      if (touch(cells, i, j, threshold2)) return true;
  }
  return false;
}

/// Joins all sets of cells that hold points not farther apart than the threshold. `set`: per cell,
/// the set it belongs to already.
void link(const LinkageCells& cells, const std::vector<Reach>& reaches, double threshold,
          const std::vector<std::uint32_t>& set, Forest& forest) {
  const auto threshold2 = static_cast<float>(threshold * threshold);
  const Runs runs(cells, set);
  const std::size_t rows = runs.row_start.size() - 1;
  const auto row_of = [&cells](std::size_t r) { return cells.rows[cells.row_start[r]]; };
  for (const Reach& reach : reaches) {
    std::size_t other = 0;  // the row reach.row ahead; both advance together
    for (std::size_t r = 0; r < rows; ++r) {
      while (other < rows && row_of(other) < row_of(r) + reach.row) ++other;
      if (other == rows) break;
      if (row_of(other) != row_of(r) + reach.row) continue;
      std::size_t first = runs.row_start[other];
      const std::size_t end = runs.row_start[other + 1];
      for (std::size_t k = runs.row_start[r]; k < runs.row_start[r + 1]; ++k) {
        const Run& a = runs.runs[k];
        const std::int32_t low = cells.columns[a.first] + reach.first_column,
                           high = cells.columns[a.last] + reach.last_column;
        while (first < end && cells.columns[runs.runs[first].last] < low) ++first;
        for (std::size_t m = first; m < end && cells.columns[runs.runs[m].first] <= high; ++m) {
          const Run& b = runs.runs[m];
          if (a.set == b.set || forest.find(a.set) == forest.find(b.set)) continue;
          if (touch(cells, a, b, reach, threshold2)) forest.unite(a.set, b.set);
        }
      }
    }
  }
}

}  // namespace

DoubleLinkage linkTwice(const std::vector<float>& x, const std::vector<float>& y,
                        double near_threshold, double far_threshold) {
  DoubleLinkage result;
  const double side = near_threshold / std::sqrt(2.0) *
                      (1 - 1e-5);  // the diagonal is below the threshold, rounding included
  const LinkageCells cells(x, y, side);
  std::vector<std::uint32_t> set(cells.count());
  std::iota(set.begin(), set.end(), 0u);
  Forest near_forest(cells.count());
  link(cells, {{0, 1, 1}, {1, -1, 1}}, near_threshold, set, near_forest);  // joins most cells
  for (std::uint32_t& s : set) s = near_forest.find(s);
  link(cells, reachesOf(side, near_threshold), near_threshold, set, near_forest);
  result.near = partitionOf(cells.cell_of_point, near_forest);

  // The near groups are the nodes of the second forest.
  for (std::size_t i = 0; i < x.size(); ++i) set[cells.cell_of_point[i]] = result.near.group[i];
  Forest far_forest(result.near.count);
  link(cells, reachesOf(side, far_threshold), far_threshold, set, far_forest);
  joinNearGroups(far_forest, result);
  return result;
}

}  // namespace perception
