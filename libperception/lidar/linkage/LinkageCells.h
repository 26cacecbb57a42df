#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Points by square cells whose diagonal is just below the small threshold: all points of a cell
/// are one group. Cells are numbered row by row and found by a table over the plane. Beyond its
/// extent the table wraps around; cells that share a slot are chained.
class LinkageCells {
 public:
  struct Box {
    float x0, y0, x1, y1;  ///< [m] about the cell's points
  };
  struct Point {
    float x, y;  ///< [m]
  };

  LinkageCells(const std::vector<float>& x, const std::vector<float>& y, double side);

  std::size_t count() const { return columns.size(); }

  static constexpr std::uint32_t kNone = ~0u;
  std::vector<std::int32_t> columns, rows;  ///< per cell
  std::vector<std::uint32_t> row_start;     ///< first cell of each non-empty row, and the end
  std::vector<std::uint32_t> start{0};      ///< index of the first point of each cell
  std::vector<Point> points;                ///< cell by cell
  std::vector<std::uint32_t> cell_of_point;
  std::vector<Box> box;

 private:
  /// The cell at that column and row, or kNone.
  std::uint32_t find(std::int32_t column, std::int32_t row) const {
    std::uint32_t cell = firstIn(slotOf(column, row));
    while (cell != kNone && (columns[cell] != column || rows[cell] != row)) cell = next_[cell];
    return cell;
  }
  std::size_t slotOf(std::int32_t column, std::int32_t row) const {
    return (static_cast<std::size_t>(static_cast<std::uint32_t>(row) & row_mask_) << column_bits_) |
           (static_cast<std::uint32_t>(column) & column_mask_);
  }

  std::uint32_t firstIn(std::size_t slot) const {
    return (taken_[slot / 64] >> slot % 64 & 1) != 0 ? table_[slot] : kNone;
  }

  /// Bits for `cells` columns or rows of the table; at most 10: it wraps beyond 1024 (360 m at 0.35
  /// m).
  static std::uint32_t bitsFor(std::int64_t cells) {
    std::uint32_t bits = 4;
    while (bits < 10 && (std::int64_t{1} << bits) < cells) ++bits;
    return bits;
  }

  /// Creates the cells in the order of their first points, chained where they share a slot.
  void place(const std::vector<float>& x, const std::vector<float>& y, double side);

  std::uint32_t add(std::int32_t column, std::int32_t row);

  /// Renumbers the cells row by row; returns the new number of each.
  std::vector<std::uint32_t> number();

  void sort(const std::vector<float>& x, const std::vector<float>& y,
            const std::vector<std::uint32_t>& number_of);

  bool wraps_ = false;
  std::uint32_t column_bits_ = 0, column_mask_ = 0, row_mask_ = 0;
  std::vector<std::uint64_t> taken_;  ///< a bit per slot: it has a cell
  std::uint32_t* table_ = nullptr;    ///< first cell of each such slot; other entries are stale
  std::vector<std::uint32_t> next_;   ///< next cell in the same slot
};

}  // namespace perception
