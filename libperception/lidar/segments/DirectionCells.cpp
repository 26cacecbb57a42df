#include "libperception/lidar/segments/DirectionCells.h"

#include <algorithm>
#include <cmath>

#include "libperception/simd/Dispatch.h"

namespace perception {

namespace {

struct RowColumn {
  std::int32_t row, column;
};

inline __attribute__((always_inline)) RowColumn rowColumnOf(float dx, float dy, float dz,
                                                            float flat) {
  constexpr auto kPerRadian = static_cast<float>(1 / DirectionCells::kPitch);
  constexpr std::int32_t kColumns = DirectionCells::kColumns, kRows = DirectionCells::kRows;
  const float azimuth = fastAtan2(dx, dy), elevation = fastAtan2(flat, dz);
  // Half a turn to one and a half, so that the modulus is one subtraction.
  std::int32_t column =
      static_cast<std::int32_t>((azimuth + 2 * static_cast<float>(kPi)) * kPerRadian);
  column -= column >= kColumns ? kColumns : 0;
  const auto row = static_cast<std::int32_t>(elevation * kPerRadian + kRows / 2.0f);
  return {std::min(std::max(row, 0), kRows - 1), column};
}

/// Cell and range [m] of each point; without branches, so that the compiler vectorizes it.
PERCEPTION_WIDEST void placePoints(const float* __restrict x, const float* __restrict y,
                                   const float* __restrict z, std::size_t count, float sx, float sy,
                                   float sz, DirectionCells::Place* __restrict place,
                                   float* __restrict range) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - sx, dy = y[i] - sy, dz = z[i] - sz;
    const RowColumn at = rowColumnOf(dx, dy, dz, std::sqrt(dx * dx + dy * dy));
    place[i] = {static_cast<std::int16_t>(at.column), static_cast<std::int16_t>(at.row)};
    range[i] = std::sqrt(dx * dx + dy * dy + dz * dz);
  }
}

/// Of each column whether a row has a return; `farthest` is row by row, 0 without a return.
PERCEPTION_WIDEST void findColumns(const float* __restrict farthest, std::uint8_t* __restrict any) {
  for (int row = 0; row < DirectionCells::kRows; ++row, farthest += DirectionCells::kColumns)
    for (int column = 0; column < DirectionCells::kColumns; ++column)
      any[column] = static_cast<std::uint8_t>(any[column] | (farthest[column] > 0));
}

}  // namespace

DirectionCells::DirectionCells(const EgoPoints& points)
    : place_(points.size()),
      range_(points.size()),
      nearest_(static_cast<std::size_t>(kColumns) * kRows, Cell{}.nearest),
      farthest_(nearest_.size() + kReadBeyond, Cell{}.farthest) {
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             sz = static_cast<float>(points.sensor.z());
  constexpr std::size_t kBlock = 512;  // points that fit in the L1 cache
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - first);
    placePoints(&points.x[first], &points.y[first], &points.z[first], count, sx, sy, sz,
                &place_[first], &range_[first]);
    for (std::size_t i = first; i < first + count; ++i) {
      const std::size_t cell = indexOf(place_[i].column, place_[i].row);
      nearest_[cell] = std::min(nearest_[cell], range_[i]);
      farthest_[cell] = std::max(farthest_[cell], range_[i]);
    }
  }
}

std::vector<std::uint8_t> DirectionCells::columnsWithReturns() const {
  std::vector<std::uint8_t> any(kColumns, 0);
  findColumns(farthest_.data(), any.data());
  return any;
}

}  // namespace perception
