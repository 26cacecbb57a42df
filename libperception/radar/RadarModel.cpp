#include "libperception/radar/RadarModel.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/radar/OutlineInView.h"

namespace perception {
namespace {

constexpr double kNearest = 0.1;           // [m] least range of a valid bearing
constexpr double kShareOfAnySpeed = 1e-3;  // share of a class's newborns with any range rate

Vector2 sensorPosition(const SensorState& s) { return s.T_world_sensor.translation().head<2>(); }

Vector2 headingVector(double yaw) { return {std::cos(yaw), std::sin(yaw)}; }
Vector2 leftOf(const Vector2& v) { return {-v.y(), v.x()}; }

bool hasRate(const Measurement& m) { return m.seen >> RadarModel::kRate & 1; }

Vector2 lineOfSight(const Measurement& m, const SensorState& s) {
  return headingVector(yawOf(s.T_world_sensor) + m.z[RadarModel::kBearing]);
}

/// Mean and variance [m, m^2] over all headings of the distance from nearest point to center of a
/// rectangle: its support function (l |cos| + w |sin|) / 2 (method.md 4.3).
ScalarEstimate halfDepth(double length, double width) {
  const double mean = (length + width) / kPi;
  const double square = 0.125 * (length * length + width * width) + length * width / kTwoPi;
  return {mean, std::max(0.0, square - mean * mean)};
}

/// Adds half of an edge's Jacobian to that of the middle bearing.
void addHalf(const AxisPrediction& outline, FootprintModel::Axis edge, AxisPrediction& out) {
  out.H_q.row(RadarModel::kBearing) += 0.5 * outline.H_q.row(edge);
  out.H_extent.row(RadarModel::kBearing) += 0.5 * outline.H_extent.row(edge);
}

/// Density [s/m] of speeds uniform over [-max, max], measured with variance `noise` [m^2/s^2].
double speedDensity(double speed, double max, double noise) {
  const double scale = 1 / std::sqrt(2 * noise);
  if (max < 1e-3) return std::exp(-0.5 * speed * speed / noise) / std::sqrt(kTwoPi * noise);
  return (std::erf((speed + max) * scale) - std::erf((speed - max) * scale)) / (4 * max);
}

}  // namespace

Vector2 sensorVelocity(const SensorState& s) {
  const Vector2 lever = sensorPosition(s) - s.ego.T_world_ego.translation().head<2>();
  return s.ego.velocity + s.ego.yaw_rate * leftOf(lever);
}

ScalarEstimate groundSpeed(const Measurement& m, const SensorState& sensor) {
  using Model = RadarModel;
  const Vector2 u = lineOfSight(m, sensor), own = sensorVelocity(sensor);
  const double turn = leftOf(u).dot(own);
  return {m.z[Model::kRate] + u.dot(own), m.R(Model::kRate, Model::kRate) +
                                              turn * turn * m.R(Model::kBearing, Model::kBearing) +
                                              2 * turn * m.R(Model::kBearing, Model::kRate)};
}

void RadarModelParams::visit(ParamVisitor& v) {
  v.real("occluded_detection", occluded_detection, {0, 1}, "",
         "factor of P_D for objects that a lidar reports as occluded");
  v.real("innovation_share", innovation_share, {1e-3, 1}, "",
         "of [filter] kinematic_exponent: range, bearing and rate as evidence of the class");
  v.real("alone_innovation_share", alone_innovation_share, {1e-3, 1}, "",
         "innovation_share for objects that no shape of a lidar's cluster has told");
  v.expert();
  v.real(
      "min_birth_speed", min_birth_speed, {0, 50}, "m/s",
      "over ground, along the line of sight: slower returns only update; 0: all may start objects");
  v.angle("birth_heading_sigma_deg", birth_heading_sigma, {1, 90},
          "of a newborn's course about the line of sight (DUC: 30); 90: unknown");
}

RadarModel::RadarModel(ClassTable classes, DetectionModel detection_model, RadarModelParams params)
    : classes_(classes),
      footprint_(std::move(classes), std::move(detection_model)),
      params_(params) {}

const std::vector<AxisKind>& RadarModel::axes() const {
  static const std::vector<AxisKind> kinds{AxisKind::kLinear, AxisKind::kAngle, AxisKind::kLinear};
  return kinds;
}

void RadarModel::predict(const Kinematics* objects, const Extent* extents, std::size_t count,
                         const SensorState& sensor, AxisPrediction* out) const {
  const Vector2 own_velocity = sensorVelocity(sensor);
  const double forward = yawOf(sensor.T_world_sensor);
  footprint_.predict(objects, extents, count, sensor, out);
  for (std::size_t i = 0; i < count; ++i) {
    AxisPrediction& p = out[i];
    if (!p.defined) continue;
    const AxisPrediction outline = p;
    const OutlineInView part = outlineInView(outline, objects[i], extents[i], sensor,
                                             0.5 * detection_model().params().fov);
    const double width = wrapAngle(part.left - part.right);
    const double bearing = wrapAngle(part.right + 0.5 * width);
    p.h[kRange] = part.range;
    p.h[kBearing] = bearing;
    p.H_q.row(kRange) = part.range_q;
    p.H_extent.row(kRange) = part.range_extent;
    p.H_q.row(kBearing).setZero();
    p.H_extent.row(kBearing).setZero();
    if (!part.left_cut) addHalf(outline, FootprintModel::kLeft, p);
    if (!part.right_cut) addHalf(outline, FootprintModel::kRight, p);
    // rho_dot = u . (V - v_s), where u turns with the bearing, method.md (16).
    const Vector2 u = headingVector(forward + bearing);
    const Vector2 relative = objects[i].q.segment<2>(Kinematics::kVx) - own_velocity;
    const double turn = leftOf(u).dot(relative);  // d(rate) / d(bearing)
    p.h[kRate] = u.dot(relative);
    p.H_q.row(kRate) = turn * p.H_q.row(kBearing);
    p.H_q.row(kRate).segment<2>(Kinematics::kVx) += u.transpose();
    p.H_extent.row(kRate) = turn * p.H_extent.row(kBearing);
    // R_model, method.md (17): uniform over the outline's width, and behind the nearest point.
    const Vector2 center = objects[i].q.head<2>() - sensorPosition(sensor);
    const double depth = 2 * std::max(0.0, center.norm() - outline.h[FootprintModel::kRange]);
    p.R_model.setZero(kAxes, kAxes);
    p.R_model(kRange, kRange) = std::pow(params_.depth_share * depth, 2);
    if (!objects[i].has_yaw && isWheeled(i)) {
      // The disc about the outline has the right width, but not the right depth.
      const Extent& e = extents[i];
      const ScalarEstimate half = halfDepth(e.length, e.width);
      p.h[kRange] = std::max(kNearest, p.h[kRange] + 0.25 * (e.length + e.width) - half.mean);
      p.H_extent.row(kRange).array() += 0.25 - 1 / kPi;
      p.R_model(kRange, kRange) += half.variance;
    }
    const double variance = width * width / 12;
    p.R_model(kBearing, kBearing) = variance;
    p.R_model(kBearing, kRate) = p.R_model(kRate, kBearing) = variance * turn;
    p.R_model(kRate, kRate) = variance * turn * turn;
  }
}

double RadarModel::detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                                        const SensorState& sensor, double visibility) const {
  const double occluded = 1 - std::clamp(visibility, 0.0, 1.0);
  // Detection depends on the edge nearest to the sensor's axis, not on the center.
  const Vector2 d = object.q.head<2>() - sensorPosition(sensor);
  const double middle = wrapAngle(std::atan2(d.y(), d.x()) - yawOf(sensor.T_world_sensor));
  AxisPrediction outline;
  footprint_.predict(&object, &extent, 1, sensor, &outline);
  double bearing = middle, nearest = 0;  // not defined: the sensor is inside the outline
  if (outline.defined) {
    nearest = outline.h[FootprintModel::kRange];
    const double left = middle + wrapAngle(outline.h[FootprintModel::kLeft] - middle);
    const double right = middle + wrapAngle(outline.h[FootprintModel::kRight] - middle);
    bearing = std::clamp(0.0, right, left);
  }
  const double range = std::max(0.0, d.norm() - 0.25 * (extent.length + extent.width));
  return edgeShare(bearing) * nearShare(nearest) *
         detection_model().detection(c, range, 0, 1 - occluded * (1 - params_.occluded_detection));
}

double RadarModel::edgeShare(double bearing) const {
  constexpr double kFaded = 3;  // deviations
  const double fov = detection_model().params().fov;
  if (fov >= kTwoPi) return 1;
  const double inside = (0.5 * fov - std::abs(wrapAngle(bearing))) / params_.view_edge;
  return inside < -kFaded ? 0 : 0.5 * std::erfc(-inside / std::sqrt(2.0));
}

double RadarModel::nearShare(double nearest) const {
  constexpr double kFade = 1, kLeast = 0.01;  // [m], of a return that noise carries past range_min
  return std::clamp((nearest - detection_model().params().range_min) / kFade, kLeast, 1.0);
}

bool RadarModel::mayDetect(const Vector2& position, double reach, const SensorState& sensor) const {
  const DetectionParams& p = detection_model().params();
  return touchesSector(position, reach, p.fov + 6 * params_.view_edge, p.range_max, sensor);
}

double RadarModel::logClutterDensity(const Measurement& m, const SensorState& sensor) const {
  // Uniform over the field of view: range / area per meter and radian, times the density of the
  // range rate, method.md (18).
  const double position = std::max(m.z[kRange], kNearest) / detection_model().area();
  double rate = 1;
  if (hasRate(m)) {
    const ScalarEstimate speed = groundSpeed(m, sensor);
    const double standing = std::exp(-0.5 * speed.mean * speed.mean / speed.variance) /
                            std::sqrt(kTwoPi * speed.variance);
    rate = params_.standing_share * standing + (1 - params_.standing_share) / params_.rate_span;
  }
  return std::log(detection_model().params().clutter_per_scan * position * rate);
}

double RadarModel::logBirthDensity(const Measurement& m, ClassId c,
                                   const SensorState& sensor) const {
  const double position = std::max(m.z[kRange], kNearest) / detection_model().area();
  double rate = 1;
  if (hasRate(m)) {
    const ScalarEstimate speed = groundSpeed(m, sensor);
    const double least =
        std::max(params_.min_birth_speed, params_.min_birth_sigmas * std::sqrt(speed.variance));
    if (params_.min_birth_speed > 0 && std::abs(speed.mean) < least) return kMinusInfinity;
    const double max = classes_[c].motion->moves ? classes_[c].max_speed : 0;
    rate = (1 - kShareOfAnySpeed) * speedDensity(speed.mean, max, speed.variance) +
           kShareOfAnySpeed / params_.rate_span;
  } else if (params_.min_birth_speed > 0) {
    return kMinusInfinity;  // not known to move
  }
  return std::log(detection_model().params().births_per_scan * position * rate);
}

std::optional<BirthState> RadarModel::birth(const Measurement& m, ClassId c,
                                            const SensorState& sensor) const {
  const ObjectClass& object_class = classes_[c];
  BirthState birth;
  Extent& e = birth.extent;
  e = {object_class.length, object_class.width,
       object_class.length_sigma * object_class.length_sigma,
       object_class.width_sigma * object_class.width_sigma};
  // The center lies half a mean depth behind the nearest point; the reflecting point is uniform
  // over the width.
  const double radius = 0.25 * (e.length + e.width);
  const ScalarEstimate half =
      object_class.motion->has_heading ? halfDepth(e.length, e.width) : ScalarEstimate{radius, 0};
  const double rho = m.z[kRange] + half.mean;
  const Vector2 away = lineOfSight(m, sensor), across = leftOf(away);
  const double along_variance =
      m.R(kRange, kRange) + (e.var_length + e.var_width) / (kPi * kPi) + half.variance;
  const double across_variance = rho * rho * m.R(kBearing, kBearing) + radius * radius / 3;
  birth.position = sensorPosition(sensor) + rho * away;
  birth.covariance =
      along_variance * away * away.transpose() + across_variance * across * across.transpose();
  if (hasRate(m) && object_class.motion->moves) {
    RadialSpeed speed;
    speed.direction = away;
    speed.along = groundSpeed(m, sensor);
    if (params_.birth_heading_sigma < radians(89)) {
      speed.across_sigma =
          std::max(0.5, std::abs(speed.along.mean) * std::tan(params_.birth_heading_sigma));
    }
    birth.radial_speed = speed;
  }
  return birth;
}

}  // namespace perception
