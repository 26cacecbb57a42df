#include "libperception/grid/StopAdvice.h"

#include <algorithm>

namespace perception {

void StopParams::visit(ParamVisitor& v) {
  v.real("deceleration", deceleration, {0.5, 12}, "m/s^2", "of braking, for the stop advice");
  v.real("reaction", reaction, {0, 5}, "s", "from a scan to full braking");
}

Corridor drivenCorridor(const Pose3& T_world_ego, double speed, double yaw_rate, double front,
                        const StopParams& params) {
  Corridor lane;
  lane.T_world_ego = T_world_ego;
  lane.width = params.width;
  lane.from = front;
  lane.max = params.look_ahead;
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

}  // namespace perception
