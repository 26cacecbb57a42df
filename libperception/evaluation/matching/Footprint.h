#pragma once
#include "libperception/core/Frames.h"

namespace perception {

/// Footprint of an object: a rectangle on the ground, world frame; a line or a point where sizes
/// are 0.
struct Footprint {
  Vector2 center = Vector2::Zero();  ///< [m]
  double yaw = 0;                    ///< [rad] of the length axis
  double length = 0, width = 0;      ///< [m]
};

/// A footprint with values that are not finite (unknown in the truth) set to 0.
Footprint makeFootprint(const Vector3& position, double yaw, double length, double width);

/// The point of the rectangle, border and inside, that is nearest to `point` [m], world.
Vector2 closestPoint(const Footprint& footprint, const Vector2& point);

/// Range and bearing of an object from the origin of the ego frame, in the ground plane.
struct GroundView {
  double closest_range =
      0;  ///< [m] to the closest point of the footprint (the range of [radecki2016]; method.md 11)
  double range = 0;    ///< [m] to the center
  double bearing = 0;  ///< [rad] of the center, ego frame, left positive, in (-pi, pi]
};

GroundView viewFrom(const Pose3& T_world_ego, const Footprint& footprint);

/// True in the disc sector ahead: |bearing| <= fov / 2 and range <= `range`; borders included.
bool inSector(const GroundView& view, double range, double fov);

}  // namespace perception
