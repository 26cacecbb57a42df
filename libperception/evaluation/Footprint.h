#pragma once
#include "libperception/core/Frames.h"

namespace perception {

/// The rectangle that an object covers of the ground, world frame. Sizes of 0 make it a line or a
/// point.
struct Footprint {
  Vector2 center = Vector2::Zero();  ///< [m]
  double yaw = 0;                    ///< [rad] of the length axis
  double length = 0, width = 0;      ///< [m]
};

/// A footprint with everything that is not finite (unknown in the truth) set to 0.
Footprint makeFootprint(const Vector3& position, double yaw, double length, double width);

/// The point of the rectangle, border and inside, that is nearest to `point` [m], world.
Vector2 closestPoint(const Footprint& footprint, const Vector2& point);

/// Where an object stands as seen from the vehicle's origin, on the ground plane.
struct GroundView {
  double closest_range =
      0;  ///< [m] to the closest point of the footprint (the range of [radecki2016]; method.md 11)
  double range = 0;    ///< [m] to the center
  double bearing = 0;  ///< [rad] of the center, ego frame, left positive, in (-pi, pi]
};

GroundView viewFrom(const Pose3& T_world_ego, const Footprint& footprint);

/// True in the disc sector ahead: |bearing| <= fov / 2 and range <= `range`; borders belong to it.
bool inSector(const GroundView& view, double range, double fov);

}  // namespace perception
