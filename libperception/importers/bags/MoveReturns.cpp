#include "libperception/importers/bags/MoveReturns.h"

#include <cmath>
#include <utility>
#include <variant>

#include "libperception/importers/clouds/ImportClouds.h"

namespace perception {

bool isNamedAsWorld(const std::string& frame) {
  return frame == "map" || frame == "odom" || frame == "world" || frame == "earth";
}

void moveReturns(const Pose3& T_to_from, SensorFrame& frame) {
  if (auto* const cloud = std::get_if<LidarCloud>(&frame.data))
    *cloud = inFrame(std::move(*cloud), T_to_from);
  auto* const radar = std::get_if<RadarReturns>(&frame.data);
  if (radar == nullptr) return;
  for (RadarReturn& r : radar->returns) {
    const double up = r.elevation.value_or(0), across = r.range * std::cos(up);
    const Vector3 p = T_to_from * Vector3(across * std::cos(r.bearing),
                                          across * std::sin(r.bearing), r.range * std::sin(up));
    r.range = p.norm();
    r.bearing = std::atan2(p.y(), p.x());
    if (r.elevation) r.elevation = std::atan2(p.z(), std::hypot(p.x(), p.y()));
  }
}

}  // namespace perception
