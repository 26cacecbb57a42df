#include "libperception/simulation/TruthVisibility.h"

#include <algorithm>

#include "libperception/simulation/cameras/CameraBoxes.h"

namespace perception {
namespace {

// KITTI's levels of occlusion from the visible share; 3 ("unknown") if almost nothing is visible.
int occlusionLevel(double visible) {
  if (visible >= 0.75) return 0;
  if (visible >= 0.35) return 1;
  return visible >= 0.05 ? 2 : 3;
}

}  // namespace

void setVisibility(const World& world, LidarCaster& caster, double t,
                   std::vector<TruthObject>& rows) {
  caster.setTime(t);
  const auto& sensors = world.scenario().sensors;
  const Pose3 T_world_ego = world.ego(t).T_world_ego;
  auto looker = std::find_if(sensors.begin(), sensors.end(),
                             [](const SensorParams& s) { return s.isLidar(); });
  if (looker == sensors.end()) {
    looker = std::find_if(sensors.begin(), sensors.end(),
                          [](const SensorParams& s) { return !s.isOfEgo(); });
  }
  const SensorParams& eye = looker != sensors.end() ? *looker : sensors.front();
  const Vector3 from = (T_world_ego * eye.T_ego_sensor()).translation();
  const bool has_camera = std::any_of(sensors.begin(), sensors.end(),
                                      [](const SensorParams& s) { return s.isCamera(); });
  const auto see = [&](TruthObject& row) {
    const auto object = static_cast<std::size_t>(row.id) - 1;
    row.occluded = occlusionLevel(caster.visibleShare(from, object));
    row.truncated = has_camera ? 1 : 0;
    for (const SensorParams& sensor : sensors) {
      if (!sensor.isCamera()) continue;
      const auto outline = imageOutline(world, object, t, sensor.cameraModel(),
                                        T_world_ego * sensor.T_ego_sensor() * opticalAxes());
      if (outline) row.truncated = std::min(row.truncated, outline->truncated);
    }
  };
  caster.parallel(rows.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) see(rows[i]);
  });
}

}  // namespace perception
