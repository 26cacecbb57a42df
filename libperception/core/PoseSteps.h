#pragma once
#include "libperception/core/Frames.h"

namespace perception {

/// Pose between `a` (share 0) and `b` (share 1): linear in position, slerp in attitude. Shares
/// below 0 and above 1 extrapolate.
inline Pose3 interpolate(const Pose3& a, const Pose3& b, double share) {
  Pose3 pose = Pose3::Identity();
  pose.translation() = (1 - share) * a.translation() + share * b.translation();
  pose.linear() = Eigen::Quaterniond(a.linear())
                      .slerp(share, Eigen::Quaterniond(b.linear()))
                      .toRotationMatrix();
  return pose;
}

/// Rotation of a motion: angle [rad] times axis, in the frame that the motion starts from.
inline Vector3 turnOf(const Pose3& motion) {
  const Eigen::AngleAxisd turn(motion.linear());
  return turn.angle() * turn.axis();
}

}  // namespace perception
