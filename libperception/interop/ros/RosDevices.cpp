#include "libperception/interop/ros/RosDevices.h"

#include <cmath>

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
