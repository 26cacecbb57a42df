#pragma once
#include <Eigen/Geometry>

#include "libperception/core/math/Angle.h"

namespace perception {

// World W: z up, fixed. Ego E: x forward, y left, z up, origin on the ground. T_a_b takes points of
// b to a.
using Pose3 = Eigen::Isometry3d;
using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix2 = Eigen::Matrix2d;

/// Translation [m] and rotation Rz(yaw) Ry(pitch) Rx(roll) [rad], MRPT's order.
inline Pose3 makePose(double x, double y, double z, double yaw, double pitch = 0, double roll = 0) {
  Pose3 pose = Pose3::Identity();
  pose.translation() = Vector3(x, y, z);
  pose.linear() =
      (Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
       Eigen::AngleAxisd(roll, Vector3::UnitX()))
          .toRotationMatrix();
  return pose;
}

inline double yawOf(const Pose3& pose) {
  return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
}
inline double pitchOf(const Pose3& pose) {
  return std::atan2(-pose.linear()(2, 0), std::hypot(pose.linear()(0, 0), pose.linear()(1, 0)));
}
inline double rollOf(const Pose3& pose) {
  return std::atan2(pose.linear()(2, 1), pose.linear()(2, 2));
}

/// Rotates a vector in the plane counter-clockwise by `angle` [rad].
inline Vector2 rotate2(double angle, const Vector2& v) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

}  // namespace perception
