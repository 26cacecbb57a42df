#include "libperception/grid/way/StopAdvice.h"

#include <algorithm>
#include <cmath>

namespace perception {

void VehicleParams::visit(ParamVisitor& v) {
  v.real(
      "height", height, {0, 6}, "m",
      "of the highest point above the ground, below which the vehicle needs room; 0: its highest "
      "lidar, at least 1.7");
}

void StopParams::visit(ParamVisitor& v) {
  v.real("deceleration", deceleration, {0.5, 12}, "m/s^2", "of braking, for the stop advice");
  v.real("reaction", reaction, {0, 5}, "s", "from a scan to full braking");
}

bool isReversing(const Pose3& T_world_ego, const Vector2& velocity, const StopParams& params) {
  const Vector2 axis = T_world_ego.linear().col(0).head<2>();
  return velocity.dot(axis) < -params.reverses_above;
}

Corridor drivenCorridor(const Pose3& T_world_ego, const Vector2& velocity, double yaw_rate,
                        double front, double rear, const StopParams& params) {
  const double speed = velocity.norm();
  Corridor lane;
  lane.T_world_ego = T_world_ego;
  lane.backward = isReversing(T_world_ego, velocity, params);
  lane.width = params.width;
  lane.from = lane.backward ? rear : front;
  lane.max = std::max(params.look_ahead, lane.from + stoppingDistance(speed, 0, params));
  lane.cells = params.cells;
  if (speed > params.steers_above)
    lane.curvature = std::clamp(yaw_rate / speed, -params.sharpest, params.sharpest);
  return lane;
}

double stoppingDistance(double speed, double along, const StopParams& params) {
  const double own = speed * params.reaction + speed * speed / (2 * params.deceleration);
  const double others = along > 0 ? along * along / (2 * params.deceleration) : 0;
  return std::max(own - others, 0.0) + params.margin;
}

double safeSpeed(double way, double along, const StopParams& params) {
  const double others = along > 0 ? along * along / (2 * params.deceleration) : 0;
  const double own = way - params.margin + others;
  if (own <= 0) return 0;
  const double lost = params.deceleration * params.reaction;
  return std::sqrt(lost * lost + 2 * params.deceleration * own) - lost;
}

}  // namespace perception
