#include "libperception/measurement/models/FootprintModel.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/measurement/models/FootprintInView.h"
#include "libperception/measurement/objects/ExtentUpdate.h"
#include "libperception/measurement/objects/NewbornWidth.h"

namespace perception {
namespace {

constexpr double kWidestAngle = 0.5;  // [rad] the same where the range is not seen
constexpr double kSideSigma =
    0.5;  // [m] a complete side as a measurement of the extent (method.md 5.13)
constexpr double kBoxSigma = 0.2;  // [m] of a seen box's faces
constexpr double kSureYaw = 0.35;  // [rad] boxes of less certain direction give no heading

bool seen(const Measurement& m, FootprintModel::Axis axis) { return m.seen >> axis & 1; }

Vector2 sensorPosition(const SensorState& s) { return s.T_world_sensor.translation().head<2>(); }

double rangeOf(const Measurement& m, const SensorState& s) {
  return seen(m, FootprintModel::kRange)
             ? std::max(m.z[FootprintModel::kRange], kClearance)
             : std::max((m.position - sensorPosition(s)).norm(), kClearance);
}

/// [m] of the box of a measurement that has both edges, across the line of sight.
double boxAcross(const Measurement& m, const SensorState& s) {
  const double left = m.z[FootprintModel::kLeft], right = m.z[FootprintModel::kRight];
  const double angle = yawOf(s.T_world_sensor) + middleBearing(left, right) - m.sides->yaw;
  return m.sides->length * std::abs(std::sin(angle)) + m.sides->width * std::abs(std::cos(angle));
}

/// Log density per unit of the axes seen of a position that is uniform over the field of view,
/// times the density `per_meter` [1/m] of the width where both edges are seen (method.md (13)).
double logUniform(const Measurement& m, const DetectionModel& detection_model, const SensorState& s,
                  double per_meter) {
  const double range = rangeOf(m, s), area = detection_model.area(),
               fov = detection_model.params().fov;
  const bool edges = seen(m, FootprintModel::kLeft) || seen(m, FootprintModel::kRight);
  const bool both = seen(m, FootprintModel::kLeft) && seen(m, FootprintModel::kRight);
  double density = 1;
  if (seen(m, FootprintModel::kRange)) {
    density = edges ? range / area : range * fov / area;
    if (both) density *= range * per_meter;  // d(width) = range d(angle)
  } else {
    density = edges ? 1 / fov : 1;
    if (both) density /= kWidestAngle;
  }
  return std::log(density);
}

/// The heading (an axis) of an object of a wheeled class by its box, when it is unambiguous
/// (method.md 3.4): a side longer than the class is wide lies along it; a complete side of the
/// class's width with nothing longer is its front or rear.
std::optional<ScalarEstimate> headingFromBox(const PartialBox& box, const ObjectClass& c) {
  if (box.yaw_sigma > kSureYaw) return std::nullopt;
  const bool a_longer = box.length >= box.width;
  const double longer = a_longer ? box.length : box.width;
  const double along = a_longer ? box.yaw : box.yaw + kPi / 2;
  const double variance = box.yaw_sigma * box.yaw_sigma;
  if (longer > c.width + 3 * c.width_sigma) return ScalarEstimate{wrapAngle(along), variance};
  const bool complete = a_longer ? box.length_complete : box.width_complete;
  const bool is_width = std::abs(longer - c.width) < 1.5 * c.width_sigma;
  const bool tells =
      c.length > 1.5 * (c.width + 3 * c.width_sigma);  // shorter classes show no axis to a lidar
  if (complete && is_width && tells) return ScalarEstimate{wrapAngle(along + kPi / 2), variance};
  return std::nullopt;
}

/// Center and covariance of an object of known heading and size from its partial box: a complete
/// side keeps its middle, an incomplete one is extended away from the sensor.
void placeByBox(const PartialBox& box, double yaw, const Extent& extent, const Vector2& sensor,
                BirthState& birth) {
  const bool a_is_length = std::abs(wrapAxis(box.yaw - yaw)) < kPi / 4;
  const double side[2] = {a_is_length ? box.length : box.width,
                          a_is_length ? box.width : box.length};
  const bool complete[2] = {a_is_length ? box.length_complete : box.width_complete,
                            a_is_length ? box.width_complete : box.length_complete};
  const double size[2] = {extent.length, extent.width};
  const double variance[2] = {extent.var_length, extent.var_width};
  const Vector2 u(std::cos(yaw), std::sin(yaw));
  const Vector2 axis[2] = {u, perpendicular(u)};
  birth.position = box.center;
  birth.covariance.setZero();
  for (int i = 0; i < 2; ++i) {
    double sigma2 = kBoxSigma * kBoxSigma;
    if (!complete[i]) {
      const double away = axis[i].dot(box.center - sensor) >= 0 ? 1 : -1;
      birth.position += away * 0.5 * std::max(0.0, size[i] - side[i]) * axis[i];
      sigma2 += 0.25 * variance[i];
    }
    birth.covariance += sigma2 * axis[i] * axis[i].transpose();
  }
}

}  // namespace

FootprintModel::FootprintModel(ClassTable classes, DetectionModel detection_model)
    : classes_(std::move(classes)), detection_model_(std::move(detection_model)) {}

const std::vector<AxisKind>& FootprintModel::axes() const {
  static const std::vector<AxisKind> kinds{AxisKind::kAngle, AxisKind::kAngle, AxisKind::kLinear};
  return kinds;
}

void FootprintModel::predict(const Kinematics* objects, const Extent* extents, std::size_t count,
                             const SensorState& sensor, AxisPrediction* out) const {
  const Vector2 origin = sensorPosition(sensor);
  const double forward = yawOf(sensor.T_world_sensor);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2 d = objects[i].q.head<2>() - origin;
    if (objects[i].has_yaw) {
      predictRectangle(d, objects[i].q[Kinematics::kYaw], extents[i],
                       detection_model_.params().corner_radius, forward, out[i]);
    } else {
      predictDisc(d, extents[i], forward, out[i]);
    }
  }
}

void FootprintModel::addClassNoise(ClassId c, const Kinematics& object, const SensorState& sensor,
                                   AxisPrediction& prediction) const {
  const double noise = detection_model_.row(c).edge_noise;
  if (noise <= 0 || !prediction.defined) return;
  if (prediction.R_model.size() == 0) prediction.R_model.setZero(kAxes, kAxes);
  const Vector2 d = object.q.head<2>() - sensorPosition(sensor);
  const double variance = noise * noise / std::max(d.squaredNorm(), kClearance * kClearance);
  prediction.R_model(kLeft, kLeft) += variance;
  prediction.R_model(kRight, kRight) += variance;
}

double FootprintModel::detectionProbability(ClassId c, const Kinematics& object,
                                            const Extent& extent, const SensorState& sensor,
                                            double visibility) const {
  const Vector2 d = object.q.head<2>() - sensorPosition(sensor);
  const double range = std::max(0.0, d.norm() - 0.25 * (extent.length + extent.width));
  return detection_model_.detection(
      c, range, std::atan2(d.y(), d.x()) - yawOf(sensor.T_world_sensor), visibility);
}

double FootprintModel::shareInView(const Kinematics& object, const Extent& extent,
                                   const SensorState& sensor) const {
  const double border = 0.5 * detection_model_.params().fov;
  if (border >= kPi) return 1;
  const Vector2 d = object.q.head<2>() - sensorPosition(sensor);
  const double bearing = std::atan2(d.y(), d.x());
  const double angle = object.q[Kinematics::kYaw] - bearing;
  const double across = object.has_yaw ? extent.length * std::abs(std::sin(angle)) +
                                             extent.width * std::abs(std::cos(angle))
                                       : 0.5 * (extent.length + extent.width);
  const double half = std::atan2(0.5 * across, d.norm());
  const double middle = wrapAngle(bearing - yawOf(sensor.T_world_sensor));
  const double seen = std::min(middle + half, border) - std::max(middle - half, -border);
  return half > 0 ? std::clamp(seen / (2 * half), 0.0, 1.0) : std::abs(middle) < border;
}

double FootprintModel::logClutterDensity(const Measurement& m, const SensorState& sensor) const {
  return std::log(detection_model_.params().clutter_per_scan) +
         logUniform(m, detection_model_, sensor, 1 / kWidestClutter);
}

double FootprintModel::logBirthDensity(const Measurement& m, ClassId c,
                                       const SensorState& sensor) const {
  double per_meter = 1;
  if (seen(m, kLeft) && seen(m, kRight)) {
    const double range = rangeOf(m, sensor);
    const double width = range * wrapAngle(m.z[kLeft] - m.z[kRight]);
    const double noise = range * range * (m.R(kLeft, kLeft) + m.R(kRight, kRight));
    const NewbornWidth newborn(classes_, width, noise, m.view.has_value());
    per_meter = newborn.density(c);
    if (m.sides) per_meter *= newborn.gainInShape(c, boxAcross(m, sensor));
    if (m.view) per_meter *= newborn.gainOfShape(c, m.log_class);
  }
  return std::log(detection_model_.params().births_per_scan) +
         logUniform(m, detection_model_, sensor, per_meter);
}

std::optional<BirthState> FootprintModel::birth(const Measurement& m, ClassId c,
                                                const SensorState& sensor) const {
  const ObjectClass& object_class = classes_[c];
  BirthState birth;
  birth.extent = {object_class.length, object_class.width,
                  object_class.length_sigma * object_class.length_sigma,
                  object_class.width_sigma * object_class.width_sigma};
  const Vector2 origin = sensorPosition(sensor);
  if (m.sides && object_class.motion->has_heading) {
    birth.yaw = headingFromBox(*m.sides, object_class);
    if (birth.yaw) {
      birth.extent = updateExtent(birth.extent, *m.sides, birth.yaw->mean, kSideSigma);
      placeByBox(*m.sides, birth.yaw->mean, birth.extent, origin, birth);
      return birth;
    }
  }
  if (m.sides && !object_class.motion->moves) {
    birth.extent = updateExtent(birth.extent, *m.sides, m.sides->yaw, kSideSigma);
  }
  // Without a heading: a disc behind the nearest point; the variance of its radius covers half the
  // length and half the width.
  const double forward = yawOf(sensor.T_world_sensor);
  const bool both = seen(m, kLeft) && seen(m, kRight);
  const Vector2 d = m.position - origin;
  const double bearing =
      both ? forward + middleBearing(m.z[kLeft], m.z[kRight]) : std::atan2(d.y(), d.x());
  const Extent& e = birth.extent;
  const double radius = 0.25 * (e.length + e.width);
  const double rho = seen(m, kRange) ? m.z[kRange] + radius : d.norm();
  const Vector2 away(std::cos(bearing), std::sin(bearing)), across = perpendicular(away);
  const double range_variance =
      (seen(m, kRange) ? m.R(kRange, kRange) : m.position_sigma * m.position_sigma) +
      0.0625 * (e.var_length + e.var_width) + std::pow(0.25 * (e.length - e.width), 2);
  const double across_variance =
      both ? rho * rho * 0.25 * (m.R(kLeft, kLeft) + m.R(kRight, kRight)) + 0.01
           : m.position_sigma * m.position_sigma + radius * radius;
  birth.position = origin + rho * away;
  birth.covariance =
      range_variance * away * away.transpose() + across_variance * across * across.transpose();
  return birth;
}

}  // namespace perception
