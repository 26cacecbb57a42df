#include "libperception/lidar/linkage/LinkageCells.h"

#include <algorithm>
#include <array>
#include <utility>

namespace perception {

LinkageCells::LinkageCells(const std::vector<float>& x, const std::vector<float>& y, double side) {
  if (x.empty()) return;
  place(x, y, side);
  const std::vector<std::uint32_t> first_number = number();
  sort(x, y, first_number);
}

void LinkageCells::place(const std::vector<float>& x, const std::vector<float>& y, double side) {
  const auto [x_low, x_high] = std::minmax_element(x.begin(), x.end());
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  const double x0 = static_cast<double>(*x_low), y0 = static_cast<double>(*y_low);
  const double per_meter = 1 / side;
  const auto cells_along = [per_meter](float low, float high) {
    return 1 + static_cast<std::int64_t>((static_cast<double>(high) - static_cast<double>(low)) *
                                         per_meter);
  };
  const std::int64_t across = cells_along(*x_low, *x_high), up = cells_along(*y_low, *y_high);
  column_bits_ = bitsFor(across);
  const std::uint32_t row_bits = bitsFor(up);
  wraps_ = across > std::int64_t{1} << column_bits_ || up > std::int64_t{1} << row_bits;
  column_mask_ = (1u << column_bits_) - 1, row_mask_ = (1u << row_bits) - 1;
  const std::size_t places = std::size_t{1} << (column_bits_ + row_bits);
  thread_local std::vector<std::uint32_t> table;  // reused between scans
  if (table.size() < places) table.resize(places);
  table_ = table.data();
  taken_.assign(places / 64, 0);

  constexpr std::size_t kBlock = 512;
  std::array<std::int32_t, kBlock> column, row;
  cell_of_point.resize(x.size());
  std::int32_t last_column = -1, last_row = -1;
  std::uint32_t last = kNone;
  for (std::size_t first = 0; first < x.size(); first += kBlock) {
    const std::size_t size = std::min(kBlock, x.size() - first);
    for (std::size_t k = 0; k < size; ++k) {  // relative to the lowest, so that truncation is floor
      column[k] = static_cast<std::int32_t>((static_cast<double>(x[first + k]) - x0) * per_meter);
      row[k] = static_cast<std::int32_t>((static_cast<double>(y[first + k]) - y0) * per_meter);
    }
    for (std::size_t k = 0; k < size; ++k) {
      if (column[k] != last_column || row[k] != last_row) {  // neighbors in a scan share cells
        last_column = column[k], last_row = row[k];
        last = find(last_column, last_row);
        if (last == kNone) last = add(last_column, last_row);
      }
      cell_of_point[first + k] = last;
    }
  }
}

std::uint32_t LinkageCells::add(std::int32_t column, std::int32_t row) {
  const auto cell = static_cast<std::uint32_t>(columns.size());
  const std::size_t slot = slotOf(column, row);
  columns.push_back(column), rows.push_back(row), next_.push_back(firstIn(slot));
  table_[slot] = cell, taken_[slot / 64] |= std::uint64_t{1} << slot % 64;
  return cell;
}

std::vector<std::uint32_t> LinkageCells::number() {
  std::vector<std::uint32_t> order;
  order.reserve(columns.size());
  for (std::size_t word = 0; word < taken_.size(); ++word)
    for (std::uint64_t taken = taken_[word]; taken != 0; taken &= taken - 1) {
      const std::size_t slot = 64 * word + static_cast<std::size_t>(__builtin_ctzll(taken));
      for (std::uint32_t cell = table_[slot]; cell != kNone; cell = next_[cell])
        order.push_back(cell);
    }
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

void LinkageCells::sort(const std::vector<float>& x, const std::vector<float>& y,
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

}  // namespace perception
