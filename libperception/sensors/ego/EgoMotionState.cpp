#include "libperception/sensors/ego/EgoMotionState.h"

namespace perception {

Vector3 EgoMotionState::toWorld(const Vector3& enu) const {
  Vector3 p = enu - world_shift;
  p.head<2>() = rotate2(-world_turn, p.head<2>());
  return p;
}

}  // namespace perception
