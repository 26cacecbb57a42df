#pragma once
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/simulation/Mesh.h"

namespace perception {

struct ObjectParams;

/// One rigid part of an object; legs and arms swing about an axis across the object.
struct Part {
  Mesh mesh;                        ///< object frame: x along heading, z = 0 bottom, centered
  Vector3 pivot = Vector3::Zero();  ///< [m] a point of the axis, object frame
  double swing = 0;  ///< [rad] amplitude at full pace; the sign tells left from right
};

/// An object's parts and how fast they swing.
struct Shape {
  std::vector<Part> parts;
  double cycle = 1;      ///< [m] way of one whole swing
  double full_pace = 1;  ///< [m/s] from this speed on the swing is full
};

Shape makeShape(const ObjectParams& object);

/// Where the wheels of a car, van or bus stand: axles [m] in the object frame, outer faces at half
/// of its width.
struct Wheels {
  double front = 0, rear = 0, radius = 0;
};
Wheels wheelsOf(const ObjectParams& object);

/// Pose of a part in the object's frame after `traveled` [m] at `speed` [m/s].
Pose3 partPose(const Shape& shape, const Part& part, double traveled, double speed);

/// A square of road about `center` with heights that vary smoothly; world frame, z = 0 on average.
Mesh makeRoad(const Vector2& center, double half_side, double roughness);

}  // namespace perception
