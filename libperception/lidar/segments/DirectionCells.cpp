#include "libperception/lidar/segments/DirectionCells.h"

#include <algorithm>
#include <array>
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
                                   float sz, std::int32_t* __restrict place,
                                   float* __restrict range) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - sx, dy = y[i] - sy, dz = z[i] - sz;
    const RowColumn at = rowColumnOf(dx, dy, dz, std::sqrt(dx * dx + dy * dy));
    place[i] = at.row * DirectionCells::kColumns + at.column;
    range[i] = std::sqrt(dx * dx + dy * dy + dz * dz);
  }
}

/// The same without ranges, of offsets from the sensor.
PERCEPTION_WIDEST void placeOffsets(const float* __restrict dx, const float* __restrict dy,
                                    const float* __restrict dz, std::size_t count,
                                    DirectionCells::Place* __restrict places) {
  for (std::size_t i = 0; i < count; ++i) {
    const RowColumn at = rowColumnOf(dx[i], dy[i], dz[i], std::sqrt(dx[i] * dx[i] + dy[i] * dy[i]));
    places[i] = {static_cast<std::int16_t>(at.column), static_cast<std::int16_t>(at.row)};
  }
}

}  // namespace

void DirectionCells::placeAll(const float* dx, const float* dy, const float* dz, std::size_t count,
                              Place* places) {
  placeOffsets(dx, dy, dz, count, places);
}

DirectionCells::DirectionCells(const EgoPoints& points)
    : nearest_(static_cast<std::size_t>(kColumns) * kRows, Cell{}.nearest),
      farthest_(nearest_.size() + kReadBeyond, Cell{}.farthest) {
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             sz = static_cast<float>(points.sensor.z());
  constexpr std::size_t kBlock = 512;  // points that fit in the L1 cache
  std::array<std::int32_t, kBlock> place;
  std::array<float, kBlock> range;
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - first);
    placePoints(&points.x[first], &points.y[first], &points.z[first], count, sx, sy, sz,
                place.data(), range.data());
    for (std::size_t k = 0; k < count; ++k) {
      float& nearest = nearest_[static_cast<std::size_t>(place[k])];
      float& farthest = farthest_[static_cast<std::size_t>(place[k])];
      nearest = std::min(nearest, range[k]), farthest = std::max(farthest, range[k]);
    }
  }
}

}  // namespace perception
