#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libperception/lidar/ground/GroundSurface.h"

namespace perception {

/// The ground along one sector of a scan, from the sensor outward: cell by cell it takes the lowest
/// height of a cell for ground if the way up to it is one that a vehicle could drive
/// (method.md 8.1).
class GroundTrack {
 public:
  /// Writes heights above the plane [m] to `borders`, which are `ring` [m] apart.
  GroundTrack(const SurfaceParams& params, float ring, float* borders)
      : ring_(ring),
        step_(static_cast<float>(params.step)),
        slope_(static_cast<float>(params.slope)),
        max_step_(static_cast<float>(params.max_step)),
        steepest_(static_cast<float>(params.steepest)),
        curvature_(static_cast<float>(params.curvature)),
        borders_(borders),
        gap_(ring) {}

  /// The low height [m] of the next ring, NaN where none was seen; that return's range [m]; the
  /// largest deviation from the plane there [m].
  void offer(float low, float range, float bound) {
    const Place place{range, low};
    if (std::abs(low) <= bound) {  // false where nothing was seen
      if (isNext(place)) return accept(place);
      if (maybe_.range > 0 && continues(place)) {
        accept(maybe_);
        return accept(place);
      }
      if (mayFollow(place)) maybe_ = place;
    }
    gap_ += ring_;
  }

  /// Goes on beyond the last ground, up to that number of borders.
  void finish(std::size_t borders) {
    const std::size_t end = borders - 1;
    const float cell_end = ring_ * static_cast<float>(std::min(next_, end));
    fill(cell_end, trend_);
    // Beyond its cell a way up that ends is a crest, and a slight slope none.
    const float slope = std::min(std::min(trend_, last_) + kSlopeError, 0.0f);
    ground_ = {cell_end, ground_.height + trend_ * (cell_end - ground_.range)};
    fill(std::min(cell_end + kExtend, ring_ * static_cast<float>(end)), slope);
    const float last = ground_.height + slope * kExtend;
    while (next_ < borders) borders_[next_++] = last;
  }

 private:
  static constexpr float kSlopeError = 0.03f;  // [-] of a slope between two cells
  static constexpr float kLongest = 8;  // [m] of a gap that a vertical curve is followed over
  static constexpr float kExtend = 10;  // [m] that a slope goes on where nothing is seen

  struct Place {
    float range = 0, height = 0;  ///< [m]
  };

  /// Within a step of the last ground or of the line through it.
  bool isNext(const Place& p) const {
    const float reach = std::min(step_ + slope_ * gap_, max_step_);
    const float rise = p.height - ground_.height;
    return std::abs(rise) <= reach || std::abs(rise - trend_ * (p.range - ground_.range)) <= reach;
  }
  /// Beyond a gap, within what a vertical curve departs from the line over it.
  bool mayFollow(const Place& p) const {
    const float along = p.range - ground_.range, rise = p.height - ground_.height;
    const float reach = max_step_ + curvature_ / 2 * along * along;
    return along <= kLongest && std::abs(rise) <= steepest_ * along &&
           std::abs(rise - trend_ * along) <= reach;
  }
  /// Whether the slope from the last ground to the place in question goes on to `p`, or bends
  /// farther to the same side: an upright surface is far steeper than the way to it, the top of an
  /// obstacle or the underside of a bridge less.
  bool continues(const Place& p) const {
    const float before = maybe_.range - ground_.range, behind = p.range - maybe_.range;
    if (behind < ring_ / 2) return false;
    const float slope = (maybe_.height - ground_.height) / before;
    const float next = (p.height - maybe_.height) / behind;
    const float farther = slope > trend_ ? next - slope : slope - next;
    return std::abs(next) <= steepest_ && farther >= -kSlopeError &&
           farther <= kSlopeError + curvature_ / 2 * (before + behind);
  }
  void accept(const Place& p) {
    const float along = std::max(p.range - ground_.range, 0.01f);
    const float slope = (p.height - ground_.height) / along;
    fill(p.range, slope);
    const float bounded = std::clamp(slope, -steepest_, steepest_);
    trend_ += along / (along + ring_) * (bounded - trend_);
    if (along >= ring_ / 2) last_ = bounded;
    ground_ = p, gap_ = ring_, maybe_ = {};
  }
  /// The borders up to `range`, on a line from the last ground.
  void fill(float range, float slope) {
    for (; ring_ * static_cast<float>(next_) <= range; ++next_)
      borders_[next_] =
          ground_.height + slope * (ring_ * static_cast<float>(next_) - ground_.range);
  }

  float ring_, step_, slope_, max_step_, steepest_, curvature_;
  float* borders_;
  std::size_t next_ = 0;
  Place ground_;     ///< the last ground
  Place maybe_;      ///< ground if what follows confirms it; range 0: none
  float trend_ = 0;  ///< slope up to the last ground
  float last_ = 0;   ///< that of its last piece alone
  float gap_;        ///< [m] since it, in whole rings
};

}  // namespace perception
