#include "libperception/measurement/PositionModel.h"

#include <algorithm>
#include <cmath>

#include "libperception/measurement/ExtentUpdate.h"

namespace perception {
namespace {
constexpr double kSideSigma = 0.5;  // [m] of sides that tell none of their own
}

const std::vector<AxisKind>& PositionModel::axes() const {
  static const std::vector<AxisKind> kinds{AxisKind::kLinear, AxisKind::kLinear};
  return kinds;
}

void PositionModel::predict(const Kinematics* objects, const Extent*, std::size_t count,
                            const SensorState&, AxisPrediction* out) const {
  for (std::size_t i = 0; i < count; ++i) {
    out[i].h = objects[i].q.head<2>();
    out[i].H_q.setZero(2, 5);
    out[i].H_q(0, 0) = out[i].H_q(1, 1) = 1;
    out[i].H_extent.setZero(2, 2);
    out[i].R_model = params_.classes[i % params_.classes.size()].noise;
    out[i].defined = true;
  }
}

bool PositionModel::inView(const Vector2& position, const SensorState& sensor) const {
  const Vector2 d = position - sensor.T_world_sensor.translation().head<2>();
  const double range = d.norm();
  if (range > params_.range) return false;
  if (params_.fov >= kTwoPi) return true;
  const Vector2 forward = sensor.T_world_sensor.linear().col(0).head<2>().normalized();
  return forward.dot(d) >= range * std::cos(0.5 * params_.fov);
}

double PositionModel::detectionProbability(ClassId c, const Kinematics& object, const Extent&,
                                           const SensorState& sensor, double visibility) const {
  if (!inView(object.q.head<2>(), sensor)) return 0;
  const ClassRow& row = params_.classes[static_cast<std::size_t>(c)];
  const double range = (object.q.head<2>() - sensor.T_world_sensor.translation().head<2>()).norm();
  const double far = (range - row.full_range) / (row.last_range - row.full_range);
  return row.detection * (1 - std::clamp(far, 0.0, 1.0)) * visibility;
}

bool PositionModel::mayDetect(const Vector2& position, double reach,
                              const SensorState& sensor) const {
  return touchesSector(position, reach, params_.fov, params_.range, sensor);
}

double PositionModel::logLabelLikelihood(int label, ClassId c) const {
  return std::log(
      params_.classes[static_cast<std::size_t>(c)].labels[static_cast<std::size_t>(label)]);
}

double PositionModel::logLabelClutter(int label) const {
  return std::log(params_.clutter_labels[static_cast<std::size_t>(label)]);
}

double PositionModel::logClutterDensity(const Measurement&, const SensorState&) const {
  return std::log(params_.clutter_per_scan / area());
}

double PositionModel::logBirthDensity(const Measurement&, ClassId, const SensorState&) const {
  return std::log(params_.births_per_scan / area());
}

std::optional<BirthState> PositionModel::birth(const Measurement& m, ClassId c,
                                               const SensorState&) const {
  BirthState birth;
  birth.position = m.z;
  birth.covariance = m.R + params_.classes[static_cast<std::size_t>(c)].noise;
  birth.extent = params_.classes[static_cast<std::size_t>(c)].extent;
  if (m.sides) birth.extent = updateExtent(birth.extent, *m.sides, m.sides->yaw, kSideSigma);
  return birth;
}

}  // namespace perception
