#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace perception {

/// A place in cells from the corner of a window, and how it lies to the slab of heights that
/// matter.
struct WindowPlace {
  float x, y, z;    ///< [cells]
  float low, high;  ///< [m] above the slab's lower side, below its upper side
};

/// How beams of a window are divided into fans: by octant (its face, then whether it falls aside),
/// then by slope.
struct FanBins {
  float per_slope = 1;      ///< fans per unit of slope across
  std::int32_t slopes = 1;  ///< fans of an octant
};

/// Some beams on their way through a window of columns, as vectors. A beam goes along the axis on
/// which it is longest (its face); everything else is linear in the distance along that axis.
struct BeamBlock {
  static constexpr std::size_t kSize = 256;
  template <class Number>
  using Lane = std::array<Number, kSize>;

  Lane<float> x, y, z, low, high;  ///< ends, as in WindowPlace
  std::size_t count = 0;

  // What prepare() makes of them.
  Lane<float> across, up;                 ///< [-] cells aside and upwards per cell along
  Lane<float> from, to;                   ///< [cells] along, from the sensor; none where to <= from
  Lane<std::int32_t> face;                ///< 0: x grows, 1: x falls, 2: y grows, 3: y falls
  Lane<std::int32_t> bin_across, bin_up;  ///< of BeamCover's finest octave
  Lane<std::int32_t> fan;                 ///< of BeamFans

  void add(const WindowPlace& end) {
    x[count] = end.x, y[count] = end.y, z[count] = end.z;
    low[count] = end.low, high[count] = end.high, ++count;
  }
  /// Cuts the beams to the window of `cells` by `cells` columns of `layers` and to the slab, and
  /// to where they enter the cells of their ends: these are not crossed.
  void prepare(const WindowPlace& origin, int cells, int layers, const FanBins& fans);
};

}  // namespace perception
