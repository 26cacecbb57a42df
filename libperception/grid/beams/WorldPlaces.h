#pragma once
#include <array>
#include <cstddef>

#include "libperception/core/Frames.h"

namespace perception {

/// World coordinates [m] of a block of points.
struct WorldPlaces {
  static constexpr std::size_t kSize = 512;  ///< points that fit in the L1 cache
  std::array<double, kSize> x, y, z;

  Vector3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  /// Of `count` <= kSize points of the ego frame [m].
  void place(const Pose3& T_world_ego, const float* ego_x, const float* ego_y, const float* ego_z,
             std::size_t count);
};

}  // namespace perception
