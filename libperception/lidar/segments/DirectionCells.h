#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/simd/RawVector.h"

namespace perception {

/// The returns of a scan by direction from the sensor: the nearest and the farthest range in cells
/// of equal azimuth and elevation (ego axes). Coarser than the beams of most sensors, so that a
/// cell without a return is a hole and not a gap between beams.
class DirectionCells {
 public:
  static constexpr double kPitch = radians(0.4);     ///< [rad] of the cells, both ways (assumed)
  static constexpr int kColumns = 900, kRows = 150;  ///< the circle; elevations of +-30 deg

  struct Cell {
    float nearest = std::numeric_limits<float>::infinity(), farthest = 0;  ///< [m]; no return
    bool empty() const { return farthest == 0; }
  };
  struct Place {
    std::int16_t column, row;
  };

  explicit DirectionCells(const EgoPoints& points);

  /// Direction of a point; elevations beyond the rows are in the outermost.
  Place placeOf(std::size_t point) const { return place_[point]; }
  /// [m] of a point from the sensor
  float rangeOf(std::size_t point) const { return range_[point]; }
  /// Whether all places up to two beside it are cells that lie row by row, without wrapping around.
  static bool isWithin(const Place& p) {
    return p.row > 1 && p.row < kRows - 2 && p.column > 1 && p.column < kColumns - 2;
  }
  /// Columns wrap around; rows beyond the cells are empty.
  Cell at(int column, int row) const {
    if (row < 0 || row >= kRows) return {};
    if (column < 0 || column >= kColumns) column = (column % kColumns + kColumns) % kColumns;
    const std::size_t i = indexOf(column, row);
    return {nearest_[i], farthest_[i]};
  }
  /// The farthest ranges [m] of a cell and those after it in its row; 0: no return. Eight may be
  /// read, of which those beyond the row's end belong to other directions.
  const float* farthestFrom(int column, int row) const { return &farthest_[indexOf(column, row)]; }
  /// 1 for each column in which a row has a return, else 0.
  std::vector<std::uint8_t> columnsWithReturns() const;

 private:
  static constexpr std::size_t kReadBeyond = 8;  ///< cells after the last, without return
  static std::size_t indexOf(int column, int row) {
    return static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column);
  }

  RawVector<Place> place_;                 ///< of the points
  RawVector<float> range_;                 ///< of the points
  std::vector<float> nearest_, farthest_;  ///< row by row
};

}  // namespace perception
