#include "libperception/measurement/frames/AirClouds.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {

double AirClouds::at(const Vector2& place) const {
  const Vector3 p =
      T_sensor_world * Vector3(place.x(), place.y(), -T_sensor_world.translation().z());
  if (std::hypot(p.x(), p.y()) > kReach) return 0;
  const double turn = std::atan2(p.y(), p.x()) / kTwoPi + 0.5;
  const auto sector = static_cast<std::size_t>(turn * static_cast<double>(kSectors));
  return probability[std::min(sector, kSectors - 1)];
}

}  // namespace perception
