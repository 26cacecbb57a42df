#pragma once
#include <cstddef>
#include <deque>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Velocity and yaw rate of the vehicle by its poses alone.
struct PoseMotion {
  Vector2 velocity = Vector2::Zero();  ///< [m/s] world
  double yaw_rate = 0;                 ///< [rad/s]
};

/// The motion at `stamp` by `poses`, in the order of their stamps. Of poses that follow one another
/// smoothly it is the difference of those about the instant, a tenth of a second apart. Where their
/// noise makes that too uncertain, it is the slope of the parabola through the poses of as long a
/// time as it takes, at most a second. Zero for fewer than two poses.
PoseMotion motionAt(const std::deque<EgoState>& poses, Stamp stamp);

}  // namespace perception
