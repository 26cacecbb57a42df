#pragma once
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Velocity of a radar over ground, from the range rates of standing things.
struct SensorVelocity {
  Stamp stamp;
  Vector2 velocity = Vector2::Zero();         ///< [m/s] sensor frame
  Matrix2 information = Matrix2::Identity();  ///< sum of the squared directions of the returns
};

/// The velocity with which the range rates of most returns agree. Empty if less than half of the
/// returns agree with one velocity, or if all of these lie in about the same direction.
std::optional<SensorVelocity> radarVelocity(const RadarReturns& radar, Stamp stamp);

}  // namespace perception
