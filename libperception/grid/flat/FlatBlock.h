#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/beams/WindowFrame.h"

namespace perception {

/// Bins of bearing in the plane.
struct BearingBins {
  float x = 0, y = 0;      ///< [cells] position of the sensor
  float per_radian = 1;    ///< bearings
  std::int32_t count = 1;  ///< of the full circle
};

/// A block of hits for a 2D grid. Lanes without a valid hit hold neutral values.
struct FlatBlock {
  static constexpr std::size_t kSize = 256;
  static constexpr float kNone = 3e38F;  ///< [cells^2] beyond any range
  static constexpr int kWhole = 255;     ///< mark of a hit of full weight
  template <class Number>
  using Lane = std::array<Number, kSize>;

  Lane<std::int32_t> column;   ///< [y][x]; one behind the window's last one for hits that mark none
  Lane<std::int32_t> mark;     ///< its weight in units of 1 / kWhole; only with weights
  Lane<std::int32_t> bearing;  ///< BearingBins::count in the sensor's own cell
  Lane<float> range;           ///< [cells^2] squared
  Lane<float> stop;            ///< range if the hit stops its beam, else kNone
  Lane<float> pass;            ///< range if it does not, else 0; only if `passes`
  bool passes = false;         ///< some hit does not stop its beam
  std::size_t hits = 0;        ///< number that mark a column
  std::size_t not_finite = 0;  ///< number that are not finite

  /// Hits `first` to `first + count - 1`. `weights`: of these, or null when all are 1.
  void place(const GridPoints& points, const float* weights, std::size_t first, std::size_t count,
             const WindowFrame& frame, const BearingBins& bins);
  /// Sets the weights of columns to the maximum with those of their hits. One byte behind the last
  /// column is undefined.
  void markColumns(bool weighted, std::uint8_t* weights) const;
};

/// A block of points that are no hits.
struct ClearBlock {
  static constexpr std::size_t kSize = FlatBlock::kSize;

  FlatBlock::Lane<std::int32_t> bearing;  ///< BearingBins::count in the sensor's own cell
  FlatBlock::Lane<float> range;           ///< [cells^2] squared; 0 behind the last point
  std::size_t not_finite = 0;

  void place(const GridPoints& points, std::size_t first, std::size_t count, PointOffset from,
             const BearingBins& bins);
};

/// Bounds of a block of points, without their bearings.
struct ClearSurvey {
  float farthest = 0;      ///< [cells^2] squared range; may be NaN
  unsigned quadrants = 0;  ///< a bit per quadrant with points: + 1 for negative x, + 2 for y
  bool all_finite = true;
};
/// Bounds of ClearBlock::kSize points from `first` on.
ClearSurvey surveyClear(const GridPoints& points, std::size_t first, PointOffset from,
                        const BearingBins& bins);

}  // namespace perception
