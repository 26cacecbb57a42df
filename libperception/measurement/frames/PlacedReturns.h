#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Returns of one lidar scan with their heights above the ground, for the safety grid. Ego frame;
/// the vectors have the same size, or are empty.
struct PlacedReturns {
  std::vector<float> x, y, z;         ///< [m]
  std::vector<float> height;          ///< [m] above the local ground
  std::vector<std::uint32_t> source;  ///< index in the frame's cloud
  /// [0, 1] P(phantom) of its cluster, or kNoCluster. Empty: clusters are not told by their shape.
  std::vector<float> phantom;
  static constexpr float kNoCluster = -1;
  /// Of obstacle returns, [0, 1] share of the directions about each that end there: 1 as of a wall,
  /// near 0 in a cloud; kFewDirections: too few tell. Empty: nothing can make phantoms at present.
  std::vector<float> solid;
  static constexpr float kFewDirections = -1;
  /// [m] from the sensor, up to which most flakes and drops return: 95 % of those of recorded snow
  /// lie within 11 m [kurup2021]. So near, `solid` is of smooth surfaces and of more directions.
  static constexpr float kFlakesWithin = 11.5F;
  double height_min = 0, height_max = 0;       ///< [m] above ground: the slab of obstacles
  double vehicle_front = 0, vehicle_rear = 0;  ///< [m] own vehicle ahead of the ego origin, behind

  std::size_t size() const { return x.size(); }
};

}  // namespace perception
