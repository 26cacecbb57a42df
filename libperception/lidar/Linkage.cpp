#include "libperception/lidar/Linkage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "libperception/lidar/Forest.h"

namespace perception {

namespace {

/// Points by square cells whose diagonal is just below the small threshold: all points of a cell
/// are one group. Cells are numbered row by row. A table of the plane finds them, which wraps
/// around where the points spread farther than it reaches: then several cells share a place of it.
class Cells {
 public:
  struct Box {
    float x0, y0, x1, y1;  ///< [m] about the cell's points
  };
  struct Point {
    float x, y;  ///< [m]
  };

  Cells(const std::vector<float>& x, const std::vector<float>& y, double side) {
    if (x.empty()) return;
    place(x, y, side);
    const std::vector<std::uint32_t> first_number = number();
    sort(x, y, first_number);
  }

  std::size_t count() const { return columns.size(); }

  static constexpr std::uint32_t kNone = ~0u;
  std::vector<std::int32_t> columns, rows;  ///< per cell
  std::vector<std::uint32_t> row_start;     ///< first cell of each row that has cells, and the end
  std::vector<std::uint32_t> start{0};      ///< first place of each cell's points
  std::vector<Point> points;                ///< cell by cell
  std::vector<std::uint32_t> cell_of_point;
  std::vector<Box> box;

 private:
  /// The cell there, or kNone.
  std::uint32_t find(std::int32_t column, std::int32_t row) const {
    std::uint32_t cell = table_[slotOf(column, row)];
    while (cell != kNone && (columns[cell] != column || rows[cell] != row)) cell = next_[cell];
    return cell;
  }
  std::size_t slotOf(std::int32_t column, std::int32_t row) const {
    return (static_cast<std::size_t>(static_cast<std::uint32_t>(row) & row_mask_) << column_bits_) |
           (static_cast<std::uint32_t>(column) & column_mask_);
  }

  /// Bits of a table's side that holds `cells` cells: wraps beyond 1024 (360 m at 0.35 m).
  static std::uint32_t bitsFor(std::int64_t cells) {
    std::uint32_t bits = 4;
    while (bits < 10 && (std::int64_t{1} << bits) < cells) ++bits;
    return bits;
  }

  /// Cells in the order of their first points, chained where they share a place.
  void place(const std::vector<float>& x, const std::vector<float>& y, double side) {
    const auto [x_low, x_high] = std::minmax_element(x.begin(), x.end());
    const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
    const double x0 = static_cast<double>(*x_low), y0 = static_cast<double>(*y_low);
    const double per_metre = 1 / side;
    const auto cells_along = [per_metre](float low, float high) {
      return 1 + static_cast<std::int64_t>((static_cast<double>(high) - static_cast<double>(low)) *
                                           per_metre);
    };
    const std::int64_t across = cells_along(*x_low, *x_high), up = cells_along(*y_low, *y_high);
    column_bits_ = bitsFor(across);
    const std::uint32_t row_bits = bitsFor(up);
    wraps_ = across > std::int64_t{1} << column_bits_ || up > std::int64_t{1} << row_bits;
    column_mask_ = (1u << column_bits_) - 1, row_mask_ = (1u << row_bits) - 1;
    table_.assign(std::size_t{1} << (column_bits_ + row_bits), kNone);

    constexpr std::size_t kBlock = 512;
    std::array<std::int32_t, kBlock> column, row;
    cell_of_point.resize(x.size());
    std::int32_t last_column = -1, last_row = -1;
    std::uint32_t last = kNone;
    for (std::size_t first = 0; first < x.size(); first += kBlock) {
      const std::size_t size = std::min(kBlock, x.size() - first);
      for (std::size_t k = 0; k < size; ++k) {  // from the lowest on, so truncation is floor
        column[k] = static_cast<std::int32_t>((static_cast<double>(x[first + k]) - x0) * per_metre);
        row[k] = static_cast<std::int32_t>((static_cast<double>(y[first + k]) - y0) * per_metre);
      }
      for (std::size_t k = 0; k < size; ++k) {
        if (column[k] != last_column || row[k] != last_row) {  // neighbours in a scan share cells
          last_column = column[k], last_row = row[k];
          last = find(last_column, last_row);
          if (last == kNone) last = add(last_column, last_row);
        }
        cell_of_point[first + k] = last;
      }
    }
  }

  std::uint32_t add(std::int32_t column, std::int32_t row) {
    const auto cell = static_cast<std::uint32_t>(columns.size());
    std::uint32_t& slot = table_[slotOf(column, row)];
    columns.push_back(column), rows.push_back(row), next_.push_back(slot);
    slot = cell;
    return cell;
  }

  /// Renumbers the cells row by row; the new number of each.
  std::vector<std::uint32_t> number() {
    std::vector<std::uint32_t> order;
    order.reserve(columns.size());
    for (std::uint32_t cell : table_)
      for (; cell != kNone; cell = next_[cell]) order.push_back(cell);
    if (wraps_)
      std::sort(order.begin(), order.end(), [this](std::uint32_t i, std::uint32_t j) {
        return rows[i] < rows[j] || (rows[i] == rows[j] && columns[i] < columns[j]);
      });
    std::vector<std::uint32_t> number_of(columns.size());
    std::vector<std::int32_t> new_columns(columns.size()), new_rows(columns.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) {
      number_of[order[k]] = k;
      new_columns[k] = columns[order[k]], new_rows[k] = rows[order[k]];
    }
    columns = std::move(new_columns), rows = std::move(new_rows);
    for (std::uint32_t k = 0; k < rows.size(); ++k)
      if (k == 0 || rows[k] != rows[k - 1]) row_start.push_back(k);
    row_start.push_back(static_cast<std::uint32_t>(rows.size()));
    return number_of;
  }

  void sort(const std::vector<float>& x, const std::vector<float>& y,
            const std::vector<std::uint32_t>& number_of) {
    start.assign(columns.size() + 1, 0);
    for (std::uint32_t& cell : cell_of_point) {
      cell = number_of[cell];
      ++start[cell + 1];
    }
    for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
    points.resize(x.size());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < x.size(); ++i) points[next[cell_of_point[i]]++] = {x[i], y[i]};
    box.resize(columns.size());
    for (std::size_t k = 0; k < box.size(); ++k) {
      Box b{1e30f, 1e30f, -1e30f, -1e30f};
      for (std::uint32_t p = start[k]; p < start[k + 1]; ++p) {
        b.x0 = std::min(b.x0, points[p].x), b.x1 = std::max(b.x1, points[p].x);
        b.y0 = std::min(b.y0, points[p].y), b.y1 = std::max(b.y1, points[p].y);
      }
      box[k] = b;
    }
  }

  bool wraps_ = false;
  std::uint32_t column_bits_ = 0, column_mask_ = 0, row_mask_ = 0;
  std::vector<std::uint32_t> table_;  ///< first cell of each place
  std::vector<std::uint32_t> next_;   ///< further cell of the same place
};

/// Whether some point of cell i is within sqrt(threshold2) of some point of cell j.
bool touch(const Cells& cells, std::uint32_t i, std::uint32_t j, float threshold2) {
  const Cells::Box &a = cells.box[i], &b = cells.box[j];
  const auto gap2 = [](float x0, float x1, float y0, float y1, const Cells::Box& box) {
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

/// Cells of this or a following row that may hold points within the threshold of a cell's points.
struct Reach {
  std::int32_t row, first_column, last_column;  ///< relative to the cell
};

/// One half of the plane about a cell.
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

/// Neighbouring cells of a row that are joined already.
struct Run {
  std::uint32_t first, last;  ///< cells
  std::uint32_t set;          ///< of the forest, when the run was made
};

struct Runs {
  Runs(const Cells& cells, const std::vector<std::uint32_t>& set) {
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
  std::vector<std::size_t> row_start;  ///< as Cells::row_start
};

/// Whether points of two runs lie within the threshold, looking at cells within reach of each
/// other.
bool touch(const Cells& cells, const Run& a, const Run& b, const Reach& reach, float threshold2) {
  std::uint32_t first = b.first;
  for (std::uint32_t i = a.first; i <= a.last; ++i) {
    while (first <= b.last && cells.columns[first] < cells.columns[i] + reach.first_column) ++first;
    for (std::uint32_t j = first;
         j <= b.last && cells.columns[j] <= cells.columns[i] + reach.last_column; ++j)
      if (touch(cells, i, j, threshold2)) return true;
  }
  return false;
}

/// Joins all sets of cells that hold points no farther apart than the threshold. `set` of each
/// cell: cells of one set are joined already.
void link(const Cells& cells, const std::vector<Reach>& reaches, double threshold,
          const std::vector<std::uint32_t>& set, Forest& forest) {
  const auto threshold2 = static_cast<float>(threshold * threshold);
  const Runs runs(cells, set);
  const std::size_t rows = runs.row_start.size() - 1;
  const auto row_of = [&cells](std::size_t r) { return cells.rows[cells.row_start[r]]; };
  for (const Reach& reach : reaches) {
    std::size_t other = 0;  // the row reach.row farther on; both advance together
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

Partition farPartition(const DoubleLinkage& linkage) {
  Partition far;
  far.count = linkage.far_count;
  far.group.reserve(linkage.near.group.size());
  for (const std::uint32_t near : linkage.near.group)
    far.group.push_back(linkage.far_of_near[near]);
  return far;
}

DoubleLinkage linkTwice(const std::vector<float>& x, const std::vector<float>& y,
                        double near_threshold, double far_threshold) {
  DoubleLinkage result;
  const double side =
      near_threshold / std::sqrt(2.0) * (1 - 1e-5);  // the diagonal stays below, rounding included
  const Cells cells(x, y, side);
  std::vector<std::uint32_t> set(cells.count());
  std::iota(set.begin(), set.end(), 0u);
  Forest near_forest(cells.count());
  link(cells, {{0, 1, 1}, {1, -1, 1}}, near_threshold, set, near_forest);  // most of what there is
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
