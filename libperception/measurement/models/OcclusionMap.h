#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// For every direction around a sensor the range of the nearest occluder. Objects whose directions
/// are occluded are not expected to be detected (negative information, method.md 5.8).
class OcclusionMap {
 public:
  /// `bins` equal sectors about the vertical axis through `origin` (world), the first starting at
  /// world yaw 0.
  OcclusionMap(const Vector2& origin, std::size_t bins);

  /// Adds an occluding return at `point` [m, world].
  void add(const Vector2& point);
  /// Share in [0, 1] of the directions between the two bearings (world yaw, counter-clockwise from
  /// `cw` to `ccw`, [rad]) in which nothing nearer than `range` - `tolerance` [m] occludes.
  double visibility(double bearing_cw, double bearing_ccw, double range, double tolerance) const;
  /// [m] nearest occluding range in the direction (world yaw); infinity where there is none.
  double nearest(double bearing) const;

 private:
  std::size_t binOf(double bearing) const;
  Vector2 origin_;
  std::vector<float> nearest_;
};

}  // namespace perception
