#pragma once
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/simulation/world/Mesh.h"

namespace perception {

struct ObjectParams;

/// One rigid part of an object; limbs swing about a lateral axis.
struct Part {
  Mesh mesh;                        ///< object frame: x along heading, z = 0 bottom, centered
  Vector3 pivot = Vector3::Zero();  ///< [m] a point of the axis, object frame
  double swing = 0;  ///< [rad] amplitude at full_pace; opposite signs for left and right
};

/// Parts of an object and the cycle of their motion.
struct Shape {
  std::vector<Part> parts;
  double cycle = 1;      ///< [m] distance traveled per cycle
  double full_pace = 1;  ///< [m/s] speed from which the amplitude is full
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

/// A square of ground about `center` of cells of `cell` [m], with heights of standard deviation
/// `roughness` [m] at their corners; world frame, mean z = 0.
Mesh makeRoad(const Vector2& center, double half_side, double cell, double roughness);

}  // namespace perception
