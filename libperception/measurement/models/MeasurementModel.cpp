#include "libperception/measurement/models/MeasurementModel.h"

#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {

double logLabelOf(const MeasurementModel& model, const Measurement& m, ClassId c) {
  return m.log_class.empty() ? model.logLabelLikelihood(m.label, c)
                             : m.log_class[static_cast<std::size_t>(c)];
}

double logLabelAndScore(const MeasurementModel& model, const Measurement& m, ClassId c) {
  return logLabelOf(model, m, c) + (m.log_class.empty() ? m.log_score_ratio : 0);
}

double logClutterLabelAndScore(const MeasurementModel& model, const Measurement& m) {
  return m.log_class.empty() ? model.logLabelClutter(m.label) : m.log_clutter;
}

bool touchesSector(const Vector2& center, double reach, double fov, double range,
                   const SensorState& sensor) {
  return touchesSector(center, reach, HalfAngle(0.5 * fov), range, sensor);
}

bool touchesSector(const Vector2& center, double reach, const HalfAngle& half_fov, double range,
                   const SensorState& sensor) {
  const Vector2 d = center - sensor.T_world_sensor.translation().head<2>();
  const double distance = d.norm();
  if (distance - reach > range) return false;
  if (half_fov.all || distance <= reach) return true;
  // Coordinates along and (positive outside) across the sector's edge on the center's side.
  const Vector2 forward = sensor.T_world_sensor.linear().col(0).head<2>().normalized();
  const double along = forward.dot(d), across = std::abs(forward.x() * d.y() - forward.y() * d.x());
  const double c = half_fov.cosine, s = half_fov.sine;
  const double beyond = across * c - along * s;
  return beyond <= 0 || (beyond <= reach && along * c + across * s >= 0);
}

AxisVector residual(const MeasurementModel& model, const Measurement& m, const AxisVector& h) {
  AxisVector y(kMaxAxes);
  Eigen::Index rows = 0;
  const auto& axes = model.axes();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(m.seen >> i & 1)) continue;
    const auto k = static_cast<Eigen::Index>(i);
    const double difference = m.z[k] - h[k];
    y[rows++] = axes[i] == AxisKind::kAngle ? wrapAngle(difference) : difference;
  }
  y.conservativeResize(rows);
  return y;
}

}  // namespace perception
