#include "libperception/radar/OutlineInView.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {
namespace {

constexpr double kGrazing = 0.05;  // least cosine between line of sight and normal of a side

Vector2 direction(double yaw) { return {std::cos(yaw), std::sin(yaw)}; }
Vector2 perpendicular(const Vector2& v) { return {-v.y(), v.x()}; }

/// Where a line of sight enters the outline.
struct Entry {
  double range = 0;                   ///< [m]
  Vector2 normal = Vector2::UnitX();  ///< outward, at that point; world
  Vector2 size = Vector2::Zero();     ///< d(the side's distance from the center)/d(length, width)
};

std::optional<Entry> enterDisc(const Vector2& d, const Extent& extent, const Vector2& sight) {
  const double radius = 0.25 * (extent.length + extent.width);
  const double along = d.dot(sight), across = perpendicular(sight).dot(d);
  const double chord2 = radius * radius - across * across;
  if (chord2 <= 0) return std::nullopt;
  Entry e;
  e.range = along - std::sqrt(chord2);
  e.normal = (e.range * sight - d) / radius;
  e.size.setConstant(0.25);
  return e;
}

/// Entry point by the slab method: the last side that the line crosses from outside.
std::optional<Entry> enterRectangle(const Vector2& d, double yaw, const Extent& extent,
                                    const Vector2& sight) {
  const Vector2 axis[2] = {direction(yaw), perpendicular(direction(yaw))};
  const double half[2] = {0.5 * extent.length, 0.5 * extent.width};
  Entry e;
  e.range = -std::numeric_limits<double>::infinity();
  double leaves = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i) {
    const double center = axis[i].dot(d), slope = axis[i].dot(sight);
    if (std::abs(slope) < 1e-9) {
      if (std::abs(center) > half[i]) return std::nullopt;
      continue;
    }
    const double sign = slope > 0 ? -1 : 1;  // of the side that faces the sensor
    leaves = std::min(leaves, (center - sign * half[i]) / slope);
    const double range = (center + sign * half[i]) / slope;
    if (range <= e.range) continue;
    e.range = range;
    e.normal = sign * axis[i];
    e.size = i == 0 ? Vector2(0.5, 0) : Vector2(0, 0.5);
  }
  if (e.range > leaves) return std::nullopt;
  return e;
}

/// Bearing [rad] off the sensor's axis of the outline's nearest point.
double nearestBearing(const Vector2& d, const Kinematics& object, const Extent& extent,
                      double forward) {
  Vector2 nearest = d;
  if (object.has_yaw) {
    const Vector2 u = direction(object.q[Kinematics::kYaw]), n = perpendicular(u);
    nearest += std::clamp(-u.dot(d), -0.5 * extent.length, 0.5 * extent.length) * u;
    nearest += std::clamp(-n.dot(d), -0.5 * extent.width, 0.5 * extent.width) * n;
  }
  return wrapAngle(std::atan2(nearest.y(), nearest.x()) - forward);
}

}  // namespace

OutlineInView outlineInView(const AxisPrediction& outline, const Kinematics& object,
                            const Extent& extent, const SensorState& sensor, double half) {
  OutlineInView out;
  out.left = outline.h[FootprintModel::kLeft];
  out.right = outline.h[FootprintModel::kRight];
  out.range = outline.h[FootprintModel::kRange];
  out.range_q = outline.H_q.row(FootprintModel::kRange);
  out.range_extent = outline.H_extent.row(FootprintModel::kRange);
  const bool whole = half >= 0.5 * kPi || out.left < out.right ||
                     (out.left <= half && out.right >= -half) || out.right >= half ||
                     out.left <= -half;
  if (whole) return out;
  if (out.left > half) out.left = half, out.left_cut = true;
  if (out.right < -half) out.right = -half, out.right_cut = true;

  const double forward = yawOf(sensor.T_world_sensor);
  const Vector2 d = object.q.head<2>() - sensor.T_world_sensor.translation().head<2>();
  const double nearest = nearestBearing(d, object, extent, forward);
  if (nearest <= out.left && nearest >= out.right) return out;
  // The range of a convex outline decreases towards its nearest point: the border on that side has
  // the smallest.
  const Vector2 sight = direction(forward + (nearest > out.left ? out.left : out.right));
  const auto entry = object.has_yaw ? enterRectangle(d, object.q[Kinematics::kYaw], extent, sight)
                                    : enterDisc(d, extent, sight);
  if (!entry || entry->range <= 0) return out;
  // n . (r sight - d) = half size, differentiated. At grazing incidence the derivative is bounded.
  const double slope = std::min(entry->normal.dot(sight), -kGrazing);
  out.range = entry->range;
  out.range_q.setZero();
  out.range_q.head<2>() = entry->normal.transpose() / slope;
  if (object.has_yaw) {
    out.range_q[Kinematics::kYaw] =
        perpendicular(entry->normal).dot(d - entry->range * sight) / slope;
  }
  out.range_extent = entry->size.transpose() / slope;
  return out;
}

}  // namespace perception
