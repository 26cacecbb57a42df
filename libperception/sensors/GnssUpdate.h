#pragma once
#include "libperception/sensors/CEgoFilter.h"
#include "libperception/sensors/EgoMotionState.h"
#include "libperception/sensors/GnssFix.h"

namespace perception {

// What a fix of satellites says of a vehicle whose heading is known.

/// The fix as a place in the world [m]; false when it was rejected. Place and height apart:
/// receivers whose base stations differ agree in place and not in height.
bool updatePlace(CEgoFilter& filter, EgoMotionState& state, const GnssFix& fix,
                 const Vector3& world);

/// Its velocity; `yaw_rate` [rad/s] is the vehicle's.
void updateVelocity(CEgoFilter& filter, EgoMotionState& state, const GnssFix& fix, double yaw_rate);

/// Its yaw [rad] in the world, with its standard deviation [rad].
void updateYaw(CEgoFilter& filter, EgoMotionState& state, double yaw, double sigma);

}  // namespace perception
