#pragma once
#include "libperception/sensors/ego/CEgoFilter.h"
#include "libperception/sensors/ego/EgoMotionState.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

// Updates by a GNSS fix of a vehicle with known heading (method.md 1.4).

/// Update by the position `world` [m] of the antenna; false when it was rejected. Horizontal
/// position and height are gated separately: receivers with different base stations disagree in
/// height.
bool updatePlace(CEgoFilter& filter, EgoMotionState& state, const GnssFix& fix,
                 const Vector3& world);

/// Update by its velocity; `yaw_rate` [rad/s] is the vehicle's.
void updateVelocity(CEgoFilter& filter, EgoMotionState& state, const GnssFix& fix, double yaw_rate);

/// Update by a yaw [rad, world] with its standard deviation [rad].
void updateYaw(CEgoFilter& filter, EgoMotionState& state, double yaw, double sigma);

}  // namespace perception
