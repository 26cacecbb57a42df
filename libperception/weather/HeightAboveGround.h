#pragma once
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Height of returns above the ground plane, as a linear function of their coordinates in the
/// sensor frame.
class HeightAboveGround {
 public:
  HeightAboveGround(const Pose3& T_ego_sensor, const GroundPlane& ground) {
    const Vector3 normal(-ground.a, -ground.b, 1);
    const Vector3 slope = T_ego_sensor.linear().transpose() * normal;
    x_ = static_cast<float>(slope.x()), y_ = static_cast<float>(slope.y());
    z_ = static_cast<float>(slope.z());
    offset_ = static_cast<float>(normal.dot(T_ego_sensor.translation()) - ground.c);
  }
  /// [m] height of a point of the sensor frame.
  float of(float x, float y, float z) const { return x_ * x + y_ * y + z_ * z + offset_; }

 private:
  float x_, y_, z_, offset_;
};

}  // namespace perception
