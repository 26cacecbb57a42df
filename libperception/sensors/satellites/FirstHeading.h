#pragma once
#include "libperception/sensors/ego/EgoMotionState.h"
#include "libperception/sensors/ego/FusionParams.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// Estimates the vehicle's heading while it is unknown, at a fix at `enu` [m] east, north, up: by
/// the receiver's INS, two antennas, the course over ground, or the path since an earlier fix. When
/// found, the state is transformed to east, north, up; later than heading_wait the world frame is
/// kept and fixes are transformed into it.
void findHeading(EgoMotionState& state, const GnssFix& fix, const Vector3& enu,
                 const FusionParams& params);

}  // namespace perception
