#include "libperception/interop/ros/RosDevices.h"

#include <cmath>
#include <stdexcept>

#include "libperception/interop/ros/RosSensors.h"

namespace perception::ros {

LidarCloud cloudOf(const LivoxScan& message, double intensity_max) {
  constexpr double kBrightest = 255;
  const double most = intensity_max > 0 ? intensity_max : kBrightest;
  LidarCloud cloud;
  for (const LivoxPoint& p : message.points) {
    cloud.x.push_back(p.place[0]);
    cloud.y.push_back(p.place[1]);
    cloud.z.push_back(p.place[2]);
    cloud.intensity.push_back(static_cast<float>(p.reflectivity / most));
    cloud.ring.push_back(p.line);
    cloud.time_offset.push_back(static_cast<float>(1e-9 * p.offset_time));
  }
  return cloud;
}

LidarCloud cloudOf(const LaserScan& message, double intensity_max) {
  const double begin = static_cast<double>(message.angle_min);
  const double step = static_cast<double>(message.angle_increment);
  if (!std::isfinite(begin) || !std::isfinite(step))
    throw std::runtime_error("angles that are not finite");
  const bool intensities = !message.intensities.empty();
  if (intensities && message.intensities.size() != message.ranges.size())
    throw std::runtime_error("intensities are not as many as ranges");
  const bool times = message.time_increment > 0 && std::isfinite(message.time_increment);
  LidarCloud cloud;
  if (std::isfinite(message.range_max)) cloud.max_range = static_cast<double>(message.range_max);
  for (std::size_t i = 0; i < message.ranges.size(); ++i) {
    const float range = message.ranges[i];
    if (!std::isfinite(range) || range <= 0 || range < message.range_min ||
        range > message.range_max)
      continue;
    const double angle = begin + static_cast<double>(i) * step;
    cloud.x.push_back(range * static_cast<float>(std::cos(angle)));
    cloud.y.push_back(range * static_cast<float>(std::sin(angle)));
    cloud.z.push_back(0);
    if (intensities) {
      const float most = intensity_max > 0 ? static_cast<float>(intensity_max) : 1;
      cloud.intensity.push_back(message.intensities[i] / most);
    }
    if (times) cloud.time_offset.push_back(static_cast<float>(i) * message.time_increment);
  }
  return cloud;
}

RadarReturns returnsOf(const RadarTracks& message, double rate_scale) {
  RadarReturns radar;
  for (const RadarTrack& track : message.tracks) {
    const Vector3 at(track.position[0], track.position[1], track.position[2]);
    const Vector3 velocity(track.velocity[0], track.velocity[1], track.velocity[2]);
    perception::RadarReturn r;
    r.range = at.norm(), r.bearing = std::atan2(at.y(), at.x());
    r.elevation = std::atan2(at.z(), std::hypot(at.x(), at.y()));
    const double rate = velocity.dot(at) / r.range;
    r.has_rate = rate_scale != 0 && std::isfinite(rate);
    r.range_rate = r.has_rate ? rate_scale * rate : 0;
    radar.returns.push_back(r);
  }
  return radar;
}

}  // namespace perception::ros
