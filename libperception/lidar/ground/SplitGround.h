#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/lidar/EgoPoints.h"
#include "libperception/simd/Compress.h"

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

/// Heights above the ground [m] of what the safety grid tells apart, and the direction of travel.
struct SlabRules {
  float mirrored;       ///< what is not higher does not count
  float road_to;        ///< lower returns are of the road
  float low, high;      ///< bounds of obstacles
  float travel;         ///< along x: 1, or -1
  float least_forward;  ///< [-] along over across, below which a return lies behind
};

/// Parts of a block of returns, by their indices in it: obstacles, other returns that count, and
/// those of the road.
struct SlabParts {
  static constexpr std::size_t kSize = 512;  ///< returns that fit in the L1 cache
  struct Part {
    std::size_t count = 0;
    std::array<std::uint32_t, kSize + kPackSlack> index;
  };
  Part obstacles, others, road;

  /// Of `count` <= kSize returns.
  void find(const float* x, const float* y, const float* heights, std::size_t count,
            const SlabRules& rules);
};

/// Indices of the heights between `low` and `high` [m], ascending.
std::vector<std::uint32_t> heightsBetween(const std::vector<float>& heights, float low, float high);

}  // namespace perception
