#include "libperception/lidar/DirectionCells.h"

#include <algorithm>
#include <cmath>

namespace perception {

DirectionCells::Place DirectionCells::placeOf(float dx, float dy, float dz) {
  constexpr auto kPerRadian = static_cast<float>(1 / kPitch);
  const float flat = std::sqrt(dx * dx + dy * dy);
  const float azimuth = fastAtan2(dx, dy), elevation = fastAtan2(flat, dz);
  const int column = static_cast<int>((azimuth + 2 * static_cast<float>(kPi)) * kPerRadian);
  const int row = static_cast<int>(elevation * kPerRadian + kRows / 2.0f);
  return {static_cast<std::int16_t>(column % kColumns),
          static_cast<std::int16_t>(std::clamp(row, 0, kRows - 1))};
}

DirectionCells::DirectionCells(const EgoPoints& points)
    : cells_(static_cast<std::size_t>(kColumns) * kRows) {
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             sz = static_cast<float>(points.sensor.z());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float dx = points.x[i] - sx, dy = points.y[i] - sy, dz = points.z[i] - sz;
    const Place p = placeOf(dx, dy, dz);
    Cell& cell =
        cells_[static_cast<std::size_t>(p.row) * kColumns + static_cast<std::size_t>(p.column)];
    const float range = std::sqrt(dx * dx + dy * dy + dz * dz);
    cell.nearest = std::min(cell.nearest, range);
    cell.farthest = std::max(cell.farthest, range);
  }
}

const DirectionCells::Cell& DirectionCells::at(int column, int row) const {
  static const Cell none;
  if (row < 0 || row >= kRows) return none;
  const int wrapped = (column % kColumns + kColumns) % kColumns;
  return cells_[static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(wrapped)];
}

}  // namespace perception
