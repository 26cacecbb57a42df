#include "libperception/measurement/PoseNoise.h"

#include <cmath>

namespace perception {

Eigen::Matrix3d poseNoise(const OutlinePoint& left, const OutlinePoint& right,
                          const OutlinePoint& nearest, const PoseUncertainty& pose) {
  Eigen::Matrix3d J;  // by x, y [m] and yaw [rad] of the sensor
  J.row(0) << std::sin(left.direction) / left.range, -std::cos(left.direction) / left.range, -1;
  J.row(1) << std::sin(right.direction) / right.range, -std::cos(right.direction) / right.range, -1;
  J.row(2) << -std::cos(nearest.direction), -std::sin(nearest.direction), 0;
  const double xy = pose.sigma_xy * pose.sigma_xy;
  const Vector3 P(xy, xy, pose.sigma_yaw * pose.sigma_yaw);
  return J * P.asDiagonal() * J.transpose();
}

}  // namespace perception
