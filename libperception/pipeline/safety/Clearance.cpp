#include "libperception/pipeline/safety/Clearance.h"

#include <cstddef>

#include "libperception/core/Frames.h"

namespace perception {

void clearOverhead(const SensorFrame& frame, const PlacedReturns& returns, double clearance,
                   double cell, GridScan& scan) {
  constexpr double kInto = 1.5;  // cells behind the return (assumed)
  const Vector3 sensor = frame.T_ego_sensor.translation();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (static_cast<double>(returns.height[i]) < clearance) continue;
    const Vector3 p(static_cast<double>(returns.x[i]), static_cast<double>(returns.y[i]),
                    static_cast<double>(returns.z[i]));
    const double level = p.z() - frame.ground.a * p.x() - frame.ground.b * p.y() - frame.ground.c;
    if (level >= returns.height_max) continue;
    const Vector3 beyond = p + kInto * cell * (p - sensor).normalized();
    scan.clear.push_back(frame.ego.T_world_ego * beyond);
  }
}

}  // namespace perception
