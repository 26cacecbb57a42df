#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Points by square cells whose diagonal is just below the small threshold: all points of a cell
/// are one group. Cells are numbered row by row. A table of the plane finds them, which wraps
/// around where the points spread farther than it reaches: then several cells share a place of it.
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
  std::vector<std::uint32_t> row_start;     ///< first cell of each row that has cells, and the end
  std::vector<std::uint32_t> start{0};      ///< first place of each cell's points
  std::vector<Point> points;                ///< cell by cell
  std::vector<std::uint32_t> cell_of_point;
  std::vector<Box> box;

 private:
  /// The cell there, or kNone.
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

  /// Bits of a table's side that holds `cells` cells: wraps beyond 1024 (360 m at 0.35 m).
  static std::uint32_t bitsFor(std::int64_t cells) {
    std::uint32_t bits = 4;
    while (bits < 10 && (std::int64_t{1} << bits) < cells) ++bits;
    return bits;
  }

  /// Cells in the order of their first points, chained where they share a place.
  void place(const std::vector<float>& x, const std::vector<float>& y, double side);

  std::uint32_t add(std::int32_t column, std::int32_t row);

  /// Renumbers the cells row by row; the new number of each.
  std::vector<std::uint32_t> number();

  void sort(const std::vector<float>& x, const std::vector<float>& y,
            const std::vector<std::uint32_t>& number_of);

  bool wraps_ = false;
  std::uint32_t column_bits_ = 0, column_mask_ = 0, row_mask_ = 0;
  std::vector<std::uint64_t> taken_;  ///< a bit for each place that has a cell
  std::uint32_t* table_ = nullptr;    ///< first cell of each such place; the others are left over
  std::vector<std::uint32_t> next_;   ///< further cell of the same place
};

}  // namespace perception
