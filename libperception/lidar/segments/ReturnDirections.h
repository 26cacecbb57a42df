#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/simd/RawVector.h"

namespace perception {

/// Obstacle returns: positions along the ego axes and heights above the ground [m].
struct ReturnPlaces {
  const std::vector<float>&x, &y, &height;
};

using ReturnGroup = std::vector<std::uint32_t>;  ///< indices of returns, ascending

/// Directions of returns from the sensor [rad], within 1e-6.
struct ReturnDirections {
  /// `sensor`: z above the ground.
  ReturnDirections(const ReturnPlaces& places, const Vector3& sensor);
  RawVector<float> azimuth, elevation;  ///< (-pi, pi]; above the horizon
};

/// Step in azimuth between neighboring returns of one beam of a scanner [rad]: the median over
/// returns of large groups. 0: too few to tell.
double azimuthStep(const ReturnDirections& directions, const std::vector<ReturnGroup>& groups);

}  // namespace perception
