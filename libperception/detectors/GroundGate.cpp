#include "libperception/detectors/GroundGate.h"

#include <cmath>

namespace perception {

GroundGate::Rows GroundGate::bottoms(double pixels, double low, double high) const {
  const double least = pixels * height / (focal * high) - slope_sigma;
  const double most = pixels * height / (focal * low) + slope_sigma;
  return {horizon + focal * least, horizon + focal * most};
}

bool GroundGate::admits(double top, double bottom, double low, double high) const {
  const Rows rows = bottoms(bottom - top, low, high);
  return bottom >= rows.begin && bottom <= rows.end;
}

std::optional<GroundGate> groundGate(const CameraModel& camera, const Pose3& T_ego_camera,
                                     const GroundPlane& ground, double slope_sigma) {
  if (camera.fy <= 0 || camera.projection != CameraModel::Projection::kPinhole) return std::nullopt;
  const Vector3 origin = T_ego_camera.translation();
  const Vector3 up = Vector3(-ground.a, -ground.b, 1).normalized();
  GroundGate gate;
  gate.height = (origin.z() - ground.heightAt(origin.x(), origin.y())) * up.z();
  // Downward direction in the camera frame: its dot product with the ray (0, y, 1) is the slope.
  const Vector3 down = -(T_ego_camera.linear().transpose() * up);
  if (gate.height < 0.2 || down.y() < std::abs(down.z())) return std::nullopt;
  gate.focal = camera.fy * down.y();
  gate.horizon = camera.cy - camera.fy * down.z() / down.y();
  gate.slope_sigma =
      slope_sigma + std::abs(down.x()) * 0.5 * camera.width / std::max(1.0, camera.fx);
  return gate;
}

}  // namespace perception
