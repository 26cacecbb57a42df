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
    if (!(along >= 0 && along < kLength && across >= 0 && across < 2 * kHalf)) return;
    height_[static_cast<std::size_t>(along) * kCells + static_cast<std::size_t>(across)] = z;
  }
  /// [m] every meter along the corridor, as Corridor::road: between and behind the cells with
  /// returns linear and level. `unseen`: [m] from there back to the last cell
  /// before it with returns; 0 in the next one, and up to the first one.
  std::vector<float> along(const Corridor& corridor, std::vector<float>* unseen = nullptr) const;

 private:
  static constexpr float kLength = 200, kHalf = 40;  // [m] along, to each side
  static constexpr std::size_t kCells = 80, kRows = 200;

  float ahead_;
  std::vector<float> height_;  ///< NaN: none
};

}  // namespace perception
