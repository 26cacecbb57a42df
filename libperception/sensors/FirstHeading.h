#pragma once
#include "libperception/sensors/EgoMotionState.h"
#include "libperception/sensors/FusionParams.h"
#include "libperception/sensors/GnssFix.h"

namespace perception {

/// Looks for the vehicle's heading while it is not known, at a fix that lies at `enu` [m] east,
/// north, up: by the receiver itself, two antennas, the course over ground, or the way since an
/// earlier fix. When found, the state turns into east, north, up; later than heading_wait the
/// world stays as it is, and fixes are turned into it.
void findHeading(EgoMotionState& state, const GnssFix& fix, const Vector3& enu,
                 const FusionParams& params);

}  // namespace perception
