#include "libperception/lidar/outline/Outline.h"

#include <limits>

namespace perception {

Outline outlineOf(const std::vector<Vector2>& hull, const Pose3& T_world_sensor) {
  Outline outline;
  if (hull.empty()) return outline;
  const Vector2 sensor = T_world_sensor.translation().head<2>();
  const double yaw = yawOf(T_world_sensor);
  Vector2 middle = Vector2::Zero();
  for (const Vector2& p : hull) middle += (p - sensor) / static_cast<double>(hull.size());
  const double axis = std::atan2(middle.y(), middle.x());

  double left = -std::numeric_limits<double>::infinity(), right = -left, nearest = right;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2 d = hull[i] - sensor, side = hull[(i + 1) % hull.size()] - hull[i];
    const double off = wrapAngle(std::atan2(d.y(), d.x()) - axis);
    if (off > left) left = off, outline.left_range = d.norm();
    if (off < right) right = off, outline.right_range = d.norm();
    const double length2 = side.squaredNorm();
    const double along = length2 > 0 ? std::min(1.0, std::max(0.0, -d.dot(side) / length2)) : 0;
    const Vector2 closest = d + along * side;
    if (closest.norm() < nearest) nearest = closest.norm(), outline.nearest_direction = closest;
  }
  outline.left = wrapAngle(axis + left - yaw);
  outline.right = wrapAngle(axis + right - yaw);
  outline.nearest = nearest;
  outline.nearest_direction.normalize();
  return outline;
}

void markHiddenEdges(Outline& outline, const OcclusionMap& occlusion, const Pose3& T_world_sensor,
                     double margin, double step, double fov) {
  const double yaw = yawOf(T_world_sensor);
  // The edge's own bin holds the object's returns: the two bins outside of it are tested.
  const auto hiddenBeside = [&](double bearing, double range, double outward) {
    const bool at_border = fov < kTwoPi - 1e-6 && std::abs(bearing) > fov / 2 - 2 * step;
    return at_border || occlusion.nearest(yaw + bearing + outward) < range - margin ||
           occlusion.nearest(yaw + bearing + 2 * outward) < range - margin;
  };
  outline.left_hidden = hiddenBeside(outline.left, outline.left_range, step);
  outline.right_hidden = hiddenBeside(outline.right, outline.right_range, -step);
}

void markEdgesOfField(Outline& outline, const LidarField& field, double yaw, double step) {
  outline.left_hidden |= !field.hasAzimuth(yaw + outline.left + 2 * step);
  outline.right_hidden |= !field.hasAzimuth(yaw + outline.right - 2 * step);
}

void fillFootprint(const Outline& outline, double sigma_left, double sigma_right,
                   double sigma_range, const PoseUncertainty& pose, double sensor_yaw,
                   Measurement& m) {
  m.z.resize(FootprintModel::kAxes);
  m.z << outline.left, outline.right, outline.nearest;
  m.seen = FootprintModel::kAll;
  if (outline.left_hidden) m.seen = static_cast<AxisMask>(m.seen & ~(1 << FootprintModel::kLeft));
  if (outline.right_hidden) m.seen = static_cast<AxisMask>(m.seen & ~(1 << FootprintModel::kRight));

  // Derivatives of the axes with respect to the sensor's x, y and yaw.
  Eigen::Matrix3d J;
  const double left = sensor_yaw + outline.left, right = sensor_yaw + outline.right;
  J.row(FootprintModel::kLeft) << std::sin(left) / outline.left_range,
      -std::cos(left) / outline.left_range, -1;
  J.row(FootprintModel::kRight) << std::sin(right) / outline.right_range,
      -std::cos(right) / outline.right_range, -1;
  J.row(FootprintModel::kRange) << -outline.nearest_direction.x(), -outline.nearest_direction.y(),
      0;
  const Vector3 P(pose.sigma_xy * pose.sigma_xy, pose.sigma_xy * pose.sigma_xy,
                  pose.sigma_yaw * pose.sigma_yaw);
  Eigen::Matrix3d R = J * P.asDiagonal() * J.transpose();
  R.diagonal() +=
      Vector3(sigma_left * sigma_left, sigma_right * sigma_right, sigma_range * sigma_range);
  for (int axis = 0; axis < FootprintModel::kAxes; ++axis) {
    if (m.seen >> axis & 1) continue;
    m.z[axis] = 0;
    R.row(axis).setZero(), R.col(axis).setZero();
  }
  m.R = R;
}

}  // namespace perception
