#include "libperception/measurement/models/PositionModel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/measurement/objects/ExtentUpdate.h"

namespace perception {
namespace {
constexpr double kPositionSideSigma =
    0.5;  // [m] of sides without a standard deviation of their own

Vector2 forwardOf(const SensorState& sensor) {
  return sensor.T_world_sensor.linear().col(0).head<2>().normalized();
}
}  // namespace

PositionModel::PositionModel(Params params)
    : params_(std::move(params)),
      half_fov_(0.5 * params_.fov),
      log_clutter_(std::log(params_.clutter_per_scan / area())),
      log_birth_(std::log(params_.births_per_scan / area())) {}

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
  return rangeInView(position - sensor.T_world_sensor.translation().head<2>(), forwardOf(sensor)) >=
         0;
}

double PositionModel::rangeInView(const Vector2& d, const Vector2& forward) const {
  const double range = d.norm();
  if (range > params_.range) return -1;
  return params_.fov >= kTwoPi || forward.dot(d) >= range * half_fov_.cosine ? range : -1;
}

double PositionModel::detectionProbability(ClassId c, const Kinematics& object, const Extent&,
                                           const SensorState& sensor, double visibility) const {
  const double range = rangeInView(
      object.q.head<2>() - sensor.T_world_sensor.translation().head<2>(), forwardOf(sensor));
  return range < 0 ? 0
                   : params_.classes[static_cast<std::size_t>(c)].detectionAt(range) * visibility;
}

void PositionModel::placeDetection(const Vector2* places, std::size_t count,
                                   const SensorState& sensor, double* out) const {
  const Vector2 origin = sensor.T_world_sensor.translation().head<2>();
  const Vector2 forward = forwardOf(sensor);
  for (std::size_t i = 0; i < count; ++i) {
    const double range = rangeInView(places[i] - origin, forward);
    out[i] = range < 0 ? 0 : params_.classes[i].detectionAt(range);
  }
}

bool PositionModel::mayDetect(const Vector2& position, double reach,
                              const SensorState& sensor) const {
  return touchesSector(position, reach, half_fov_, params_.range, sensor);
}

double PositionModel::logLabelLikelihood(int label, ClassId c) const {
  return std::log(
      params_.classes[static_cast<std::size_t>(c)].labels[static_cast<std::size_t>(label)]);
}

double PositionModel::logLabelClutter(int label) const {
  return std::log(params_.clutter_labels[static_cast<std::size_t>(label)]);
}

double PositionModel::logClutterDensity(const Measurement&, const SensorState&) const {
  return log_clutter_;
}

double PositionModel::logBirthDensity(const Measurement&, ClassId, const SensorState&) const {
  return log_birth_;
}

std::optional<BirthState> PositionModel::birth(const Measurement& m, ClassId c,
                                               const SensorState&) const {
  BirthState birth;
  birth.position = m.z;
  birth.covariance = m.R + params_.classes[static_cast<std::size_t>(c)].noise;
  birth.extent = params_.classes[static_cast<std::size_t>(c)].extent;
  if (m.sides)
    birth.extent = updateExtent(birth.extent, *m.sides, m.sides->yaw, kPositionSideSigma);
  return birth;
}

}  // namespace perception
