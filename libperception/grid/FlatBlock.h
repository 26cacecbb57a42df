#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "libperception/grid/GridPoints.h"
#include "libperception/grid/WindowFrame.h"

namespace perception {

/// Where bearings on the ground begin and how many there are.
struct BearingBins {
  float x = 0, y = 0;      ///< [cells] the sensor
  float per_radian = 1;    ///< bearings
  std::int32_t count = 1;  ///< of the whole turn
};

/// Some hits of a scan as a grid on the ground takes them. Lanes without a hit (behind the last
/// one, no numbers) hold what changes nothing.
struct FlatBlock {
  static constexpr std::size_t kSize = 256;
  static constexpr float kNone = 3e38F;  ///< [cells^2] beyond any range
  static constexpr int kWhole = 255;     ///< mark of a hit of full weight
  template <class Number>
  using Lane = std::array<Number, kSize>;

  Lane<std::int32_t> column;   ///< [y][x]; behind the window's last one where a hit marks none
  Lane<std::int32_t> mark;     ///< its weight, of kWhole; only where hits come with weights
  Lane<std::int32_t> bearing;  ///< BearingBins::count in the sensor's own cell
  Lane<float> range;           ///< [cells^2] squared
  Lane<float> stop;            ///< the same of a hit that stops its beam, or kNone
  Lane<float> pass;            ///< of a hit that does not, or 0; only where there is one
  bool passes = false;         ///< there is such a hit
  std::size_t hits = 0;        ///< that mark a column
  std::size_t not_finite = 0;  ///< that are no numbers

  /// Hits `first` to `first + count - 1`. `weights`: of these, or null where all are trusted.
  void place(const GridPoints& points, const float* weights, std::size_t first, std::size_t count,
             const WindowFrame& frame, const BearingBins& bins);
  /// Raises the weights of columns to those of their hits. One byte behind the last column is
  /// undefined.
  void markColumns(bool weighted, std::uint8_t* weights) const;
};

/// Some points that are no hits.
struct ClearBlock {
  static constexpr std::size_t kSize = FlatBlock::kSize;

  FlatBlock::Lane<std::int32_t> bearing;  ///< BearingBins::count in the sensor's own cell
  FlatBlock::Lane<float> range;           ///< [cells^2] squared; 0 behind the last point
  std::size_t not_finite = 0;

  void place(const GridPoints& points, std::size_t first, std::size_t count, PointOffset from,
             const BearingBins& bins);
};

/// Bounds of a whole block of points, without their bearings.
struct ClearSurvey {
  float farthest = 0;      ///< [cells^2] squared range; or no number
  unsigned quadrants = 0;  ///< a bit for each that may hold one: 1 where x falls, + 2 where y does
  bool all_finite = true;
};
/// Of ClearBlock::kSize points from `first` on.
ClearSurvey surveyClear(const GridPoints& points, std::size_t first, PointOffset from,
                        const BearingBins& bins);

}  // namespace perception
