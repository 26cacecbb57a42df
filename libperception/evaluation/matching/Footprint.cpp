#include "libperception/evaluation/matching/Footprint.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

double finiteOr0(double value) { return std::isfinite(value) ? value : 0; }

// Borders of the sector are met to this accuracy [m, rad]: cos(pi/2) is not 0 in floating point.
constexpr double kBorder = 1e-9;

}  // namespace

Footprint makeFootprint(const Vector3& position, double yaw, double length, double width) {
  return {position.head<2>(), finiteOr0(yaw), std::max(0.0, finiteOr0(length)),
          std::max(0.0, finiteOr0(width))};
}

Vector2 closestPoint(const Footprint& f, const Vector2& point) {
  const Vector2 local = rotate2(-f.yaw, point - f.center);
  const Vector2 half(f.length / 2, f.width / 2);
  return f.center + rotate2(f.yaw, local.cwiseMax(-half).cwiseMin(half));
}

GroundView viewFrom(const Pose3& T_world_ego, const Footprint& footprint) {
  const Vector2 ego = T_world_ego.translation().head<2>();
  const Vector2 center = rotate2(-yawOf(T_world_ego), footprint.center - ego);
  return {(closestPoint(footprint, ego) - ego).norm(), center.norm(),
          wrapAngle(std::atan2(center.y(), center.x()))};
}

bool inSector(const GroundView& view, double range, double fov) {
  return view.range <= range + kBorder && std::abs(view.bearing) <= fov / 2 + kBorder;
}

}  // namespace perception
