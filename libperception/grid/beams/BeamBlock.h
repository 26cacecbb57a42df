#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace perception {

/// A point in cells from the corner of a window, and its distances to the bounds of the height
/// slab.
struct WindowPlace {
  float x, y, z;    ///< [cells]
  float low, high;  ///< [m] above the slab's lower side, below its upper side
};

/// Division of the beams of a window into fans: by octant (face, then sign of the slope across),
/// then by slope.
struct FanBins {
  float per_slope = 1;      ///< fans per unit of slope across
  std::int32_t slopes = 1;  ///< fans of an octant
};

/// A block of beams through a window of columns, as structure of arrays. A beam is parameterized by
/// the distance along its longest horizontal axis (its face); other coordinates are linear in it.
struct BeamBlock {
  static constexpr std::size_t kSize = 256;
  template <class Number>
  using Lane = std::array<Number, kSize>;

  Lane<float> x, y, z, low, high;  ///< end points, as in WindowPlace
  std::size_t count = 0;

  // Results of prepare().
  Lane<float> across, up;   ///< [-] slopes: cells across and upward per cell along
  Lane<float> from, to;     ///< [cells] along, from the sensor; empty where to <= from
  Lane<std::int32_t> face;  ///< 0: x grows, 1: x falls, 2: y grows, 3: y falls
  Lane<std::int32_t> bin_across, bin_up;  ///< of BeamCover's finest octave
  Lane<std::int32_t> fan;                 ///< of BeamFans

  void add(const WindowPlace& end) {
    x[count] = end.x, y[count] = end.y, z[count] = end.z;
    low[count] = end.low, high[count] = end.high, ++count;
  }
  /// Clips the beams to the window of `cells` by `cells` columns of `layers`, to the slab, and to
  /// the entry into their end cells, which are not crossed.
  void prepare(const WindowPlace& origin, int cells, int layers, const FanBins& fans);
};

}  // namespace perception
