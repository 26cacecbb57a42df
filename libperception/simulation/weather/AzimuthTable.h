#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Which things a ray from a sensor may meet, by its azimuth: so that few are looked at.
class AzimuthTable {
 public:
  AzimuthTable();
  /// Empties it for rays from `eye` [m, world].
  void reset(const Vector2& eye);
  /// A thing within `reach` [m] of `place` [m, world]; `item` is the caller's.
  void add(const Vector2& place, double reach, std::uint32_t item);
  /// Items in the direction of a ray (world), in the order in which they were added.
  const std::vector<std::uint32_t>& along(const Vector3& direction) const;
  const Vector2& eye() const { return eye_; }

 private:
  Vector2 eye_ = Vector2::Zero();
  std::vector<std::vector<std::uint32_t>> bins_;
};

}  // namespace perception
