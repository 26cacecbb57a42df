#include "libperception/packets/LidarReturn.h"

#include <cmath>

namespace perception {

std::vector<std::uint16_t> ringsOf(const std::vector<BeamAngles>& beams) {
  std::vector<std::uint16_t> rings;
  for (const BeamAngles& beam : beams) {
    std::uint16_t lower = 0;
    for (const BeamAngles& other : beams) lower += other.elevation < beam.elevation ? 1 : 0;
    rings.push_back(lower);
  }
  return rings;
}

LidarReturn returnAt(double range, double azimuth, double elevation) {
  constexpr double kRadians = M_PI / 180;
  const double flat = range * std::cos(elevation * kRadians);
  LidarReturn point;
  point.x = static_cast<float>(flat * std::cos(azimuth * kRadians));
  point.y = static_cast<float>(-flat * std::sin(azimuth * kRadians));
  point.z = static_cast<float>(range * std::sin(elevation * kRadians));
  return point;
}

}  // namespace perception
