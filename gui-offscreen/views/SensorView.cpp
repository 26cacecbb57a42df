#include "gui-offscreen/views/SensorView.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace perception {

void addReturns(const SensorFrame& frame, std::size_t most, SceneView& view) {
  if (std::holds_alternative<RadarReturns>(frame.data)) return addRadar(frame, view);
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return;
  const std::size_t count = std::min(cloud->size(), most);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * cloud->size() / count;
    const Vector3 at = frame.T_ego_sensor * Vector3(cloud->x[i], cloud->y[i], cloud->z[i]);
    if (!at.allFinite()) continue;
    const auto height = static_cast<float>(at.z() - frame.ground.heightAt(at.x(), at.y()));
    view.points.push_back(
        {frame.ego.T_world_ego * at, height, cloud->trust.empty() ? 1.0F : cloud->trust[i]});
  }
}

void addRadar(const SensorFrame& frame, SceneView& view) {
  const Pose3 T = frame.T_world_sensor();
  const Vector3 arm = T.translation() - frame.ego.T_world_ego.translation();
  const Vector2 own = frame.ego.velocity + frame.ego.yaw_rate * Vector2(-arm.y(), arm.x());
  for (const RadarReturn& r : std::get<RadarReturns>(frame.data).returns) {
    const double elevation = r.elevation.value_or(0);
    const Vector3 ray(std::cos(elevation) * std::cos(r.bearing),
                      std::cos(elevation) * std::sin(r.bearing), std::sin(elevation));
    const Vector3 u = T.linear() * ray;
    const Vector2 flat = Vector2(u.x(), u.y()).normalized();
    ViewRadarReturn shown;
    shown.place = T.translation() + r.range * u;
    shown.has_rate = r.has_rate;
    shown.radial_velocity = (r.range_rate + own.dot(flat)) * flat;
    view.radar.push_back(shown);
  }
}

}  // namespace perception
