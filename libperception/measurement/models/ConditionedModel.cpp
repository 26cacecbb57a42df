#include "libperception/measurement/models/ConditionedModel.h"

#include <cmath>

namespace perception {
namespace {

Vector2 fromSensor(const Vector2& position, const SensorState& sensor) {
  return position - sensor.T_world_sensor.translation().head<2>();
}

}  // namespace

std::size_t cellOf(const Measurement& m, const SensorState& sensor, const ViewCells& cells) {
  const Vector2 d = fromSensor(m.position, sensor);
  return cells.at(d.norm(), std::atan2(d.y(), d.x()) - yawOf(sensor.T_world_sensor));
}

double ConditionedModel::detectionProbability(ClassId c, const Kinematics& object,
                                              const Extent& extent, const SensorState& sensor,
                                              double visibility) const {
  return conditions_.seen_share *
         model_->detectionProbability(c, object, extent, sensor, visibility);
}

double ConditionedModel::logClutterDensity(const Measurement& m, const SensorState& sensor) const {
  const double configured = model_->logClutterDensity(m, sensor);
  if (!conditions_.clutter) return configured;
  const ClutterMap& map = *conditions_.clutter;
  return configured + map.logFactor(cellOf(m, sensor, map.cells()));
}

}  // namespace perception
