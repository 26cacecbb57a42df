#include "libperception/lidar/Linkage.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace perception {

namespace {

/// Union-find with path halving; the smaller root wins, so that roots do not depend on the order of
/// unions.
class Forest {
 public:
  explicit Forest(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    i = find(i), j = find(j);
    if (i < j) parent_[j] = i;
    if (j < i) parent_[i] = j;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Points by square cells whose diagonal is just below the small threshold: all points of a cell
/// are one group. Cells are numbered in the order of their first points, so nothing depends on the
/// hash.
class Cells {
 public:
  struct Box {
    float x0, y0, x1, y1;  ///< [m] about the cell's points
  };

  Cells(const std::vector<float>& x, const std::vector<float>& y, double side)
      : table_(64, kEmpty) {
    cell_of_point.resize(x.size());
    std::int32_t last_column = 0, last_row = 0;
    std::uint32_t last = kEmpty;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto column = static_cast<std::int32_t>(std::floor(static_cast<double>(x[i]) / side));
      const auto row = static_cast<std::int32_t>(std::floor(static_cast<double>(y[i]) / side));
      if (last == kEmpty || column != last_column ||
          row != last_row) {  // neighbours in a scan share cells
        last = findOrAdd(column, row);
        last_column = column, last_row = row;
      }
      cell_of_point[i] = last;
      ++start[last + 1];
    }
    for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
    px.resize(x.size()), py.resize(x.size());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    box.assign(columns.size(), Box{1e30f, 1e30f, -1e30f, -1e30f});
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::uint32_t k = cell_of_point[i], place = next[k]++;
      px[place] = x[i], py[place] = y[i];
      Box& b = box[k];
      b = {std::min(b.x0, x[i]), std::min(b.y0, y[i]), std::max(b.x1, x[i]), std::max(b.y1, y[i])};
    }
  }

  std::size_t count() const { return columns.size(); }

  /// The cell there, or kEmpty.
  std::uint32_t find(std::int32_t column, std::int32_t row) const {
    return table_[slotOf(column, row)];
  }

  static constexpr std::uint32_t kEmpty = ~0u;
  std::vector<std::int32_t> columns, rows;  ///< per cell
  std::vector<std::uint32_t> start{0};      ///< first place of each cell's points in px, py
  std::vector<float> px, py;                ///< [m] points, cell by cell
  std::vector<std::uint32_t> cell_of_point;
  std::vector<Box> box;

 private:
  std::size_t slotOf(std::int32_t column, std::int32_t row) const {
    const std::uint64_t key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(column)) << 32 |
                              static_cast<std::uint32_t>(row);
    const std::size_t mask = table_.size() - 1;
    auto slot =
        static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ull >> 24) & mask;  // Fibonacci hashing
    while (table_[slot] != kEmpty && (columns[table_[slot]] != column || rows[table_[slot]] != row))
      slot = (slot + 1) & mask;
    return slot;
  }
  std::uint32_t findOrAdd(std::int32_t column, std::int32_t row) {
    const std::size_t slot = slotOf(column, row);
    if (table_[slot] != kEmpty) return table_[slot];
    const auto cell = static_cast<std::uint32_t>(columns.size());
    table_[slot] = cell;
    columns.push_back(column), rows.push_back(row), start.push_back(0);
    if (2 * columns.size() > table_.size()) {
      table_.assign(2 * table_.size(), kEmpty);
      for (std::uint32_t k = 0; k < columns.size(); ++k) table_[slotOf(columns[k], rows[k])] = k;
    }
    return cell;
  }

  std::vector<std::uint32_t> table_;  ///< open addressing, a power of two
};

/// Whether some point of cell i is within sqrt(threshold2) of some point of cell j.
bool touch(const Cells& cells, std::uint32_t i, std::uint32_t j, float threshold2) {
  const Cells::Box& b = cells.box[j];
  for (std::uint32_t p = cells.start[i]; p < cells.start[i + 1]; ++p) {
    const float x = cells.px[p], y = cells.py[p];
    const float gap_x = std::max({b.x0 - x, x - b.x1, 0.0f}),
                gap_y = std::max({b.y0 - y, y - b.y1, 0.0f});
    if (gap_x * gap_x + gap_y * gap_y > threshold2) continue;
    for (std::uint32_t q = cells.start[j]; q < cells.start[j + 1]; ++q) {
      const float dx = x - cells.px[q], dy = y - cells.py[q];
      if (dx * dx + dy * dy <= threshold2) return true;
    }
  }
  return false;
}

/// Joins all cells that hold points no farther apart than the threshold.
void link(const Cells& cells, double side, double threshold, Forest& forest) {
  struct Offset {
    std::int32_t column, row;
  };
  std::vector<Offset>
      offsets;  // one half of the plane, near ones first: they leave less to do for far ones
  const auto reach = static_cast<std::int32_t>(std::ceil(threshold / side)) + 1;
  for (std::int32_t row = 0; row <= reach; ++row)
    for (std::int32_t column = row == 0 ? 1 : -reach; column <= reach; ++column) {
      const double gap = std::hypot(std::max(std::abs(column) - 1, 0), std::max(row - 1, 0)) * side;
      if (gap <= threshold) offsets.push_back({column, row});
    }
  std::stable_sort(offsets.begin(), offsets.end(), [](const Offset& a, const Offset& b) {
    return a.column * a.column + a.row * a.row < b.column * b.column + b.row * b.row;
  });

  const auto threshold2 = static_cast<float>(threshold * threshold);
  for (const Offset& offset : offsets)
    for (std::uint32_t i = 0; i < cells.count(); ++i) {
      const std::uint32_t j =
          cells.find(cells.columns[i] + offset.column, cells.rows[i] + offset.row);
      if (j == Cells::kEmpty || forest.find(i) == forest.find(j)) continue;
      if (touch(cells, i, j, threshold2)) forest.unite(i, j);
    }
}

Partition partitionOf(const Cells& cells, Forest& forest) {
  Partition partition;
  partition.group.resize(cells.cell_of_point.size());
  std::vector<std::uint32_t> number(cells.count(), Cells::kEmpty);
  for (std::size_t i = 0; i < partition.group.size(); ++i) {
    std::uint32_t& n = number[forest.find(cells.cell_of_point[i])];
    if (n == Cells::kEmpty) n = partition.count++;
    partition.group[i] = n;
  }
  return partition;
}

}  // namespace

DoubleLinkage linkTwice(const std::vector<float>& x, const std::vector<float>& y,
                        double near_threshold, double far_threshold) {
  DoubleLinkage result;
  const double side =
      near_threshold / std::sqrt(2.0) * (1 - 1e-5);  // the diagonal stays below, rounding included
  const Cells cells(x, y, side);
  Forest forest(cells.count());
  link(cells, side, near_threshold, forest);
  result.near = partitionOf(cells, forest);
  link(cells, side, far_threshold, forest);
  result.far = partitionOf(cells, forest);
  result.far_of_near.resize(result.near.count);
  for (std::size_t i = 0; i < x.size(); ++i)
    result.far_of_near[result.near.group[i]] = result.far.group[i];
  result.parts.assign(result.far.count, 0);
  for (const std::uint32_t far : result.far_of_near) ++result.parts[far];
  return result;
}

}  // namespace perception
