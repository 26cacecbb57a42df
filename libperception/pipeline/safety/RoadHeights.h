#pragma once
#include <cstddef>
#include <vector>

#include "libperception/grid/way/FreeDistance.h"

namespace perception {

/// Heights of the ground ahead of one scan, in cells of 1 m of the ego frame: one ground return per
/// cell. Lanes need it for hills.
class RoadHeights {
 public:
  /// `backward`: the way behind is looked at.
  explicit RoadHeights(bool backward = false);

  /// A ground return [m], ego frame.
  void add(float x, float y, float z) {
    const float along = ahead_ * x, across = y + kHalf;
    if (!(along >= 0 && along < 2 * kHalf && across >= 0 && across < 2 * kHalf)) return;
    height_[static_cast<std::size_t>(along) * kCells + static_cast<std::size_t>(across)] = z;
  }
  /// [m] every meter along the corridor, as Corridor::road: between and behind the cells with
  /// returns linear and level.
  std::vector<float> along(const Corridor& corridor) const;

 private:
  static constexpr float kHalf = 40;  // [m]
  static constexpr std::size_t kCells = 80;

  float ahead_;
  std::vector<float> height_;  ///< NaN: none
};

}  // namespace perception
