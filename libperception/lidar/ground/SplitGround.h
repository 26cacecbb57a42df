#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/EgoPoints.h"

namespace perception {

/// Criteria of ground and obstacle returns.
struct SplitRules {
  double height_min, height_max;  ///< [m] above ground
  double min_trust;               ///< [0, 1] less trusted returns are no obstacles
};

/// Labels each of the `returns` returns of a cloud: 1 for a point within `low` [m] of the ground.
void labelGround(const EgoPoints& points, const std::vector<float>& heights, float low,
                 std::size_t returns, std::vector<std::uint8_t>& ground);

/// Labels the ground, by the sensor's own label too, and finds the obstacles, as indices into
/// `points`. Mirrored returns and those above height_max are neither.
void splitGround(const LidarCloud& cloud, const EgoPoints& points,
                 const std::vector<float>& heights, const SplitRules& rules,
                 std::vector<std::uint8_t>& ground, std::vector<std::uint32_t>& obstacles);

/// Indices of the heights between `low` and `high` [m], ascending.
std::vector<std::uint32_t> heightsBetween(const std::vector<float>& heights, float low, float high);

}  // namespace perception
