#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/EgoPoints.h"

namespace perception {

/// Which returns are ground and which are obstacles.
struct SplitRules {
  double height_min, height_max;  ///< [m] above ground
  double min_trust;               ///< [0, 1] less: a phantom, no obstacle
};

/// A label for each return of a cloud of `returns`: 1 where it is a point that lies within `low`
/// [m] of the ground.
void labelGround(const EgoPoints& points, const std::vector<float>& heights, float low,
                 std::size_t returns, std::vector<std::uint8_t>& ground);

/// Labels the ground, the sensor's own label included, and finds the obstacles, places in
/// `points`: neither are what is mirrored in a wet road and what hangs above all that drives.
void splitGround(const LidarCloud& cloud, const EgoPoints& points,
                 const std::vector<float>& heights, const SplitRules& rules,
                 std::vector<std::uint8_t>& ground, std::vector<std::uint32_t>& obstacles);

}  // namespace perception
