#include "libperception/simulation/weather/Beam.h"

#include <cmath>
#include <limits>

#include "libperception/core/Angle.h"

namespace perception {

double openRange(const LidarPulse& pulse) {
  return pulse.hit.object == BeamHit::kNothing ? std::numeric_limits<double>::infinity()
                                               : static_cast<double>(pulse.hit.range);
}

void attenuate(LidarPulse& pulse, double extinction) {
  if (pulse.hit.object != BeamHit::kNothing) pulse.optical_depth += extinction * pulse.hit.range;
}

AimCell aimCell(const Vector3& aim, double size, double shift_across, double shift_up) {
  const auto columns = static_cast<std::uint32_t>(std::lround(kTwoPi / size));
  const double across = (std::atan2(aim.y(), aim.x()) + kPi) / size + shift_across,
               up = (std::atan2(aim.z(), std::hypot(aim.x(), aim.y())) + kPi / 2) / size + shift_up;
  const auto column = static_cast<std::uint32_t>(across), row = static_cast<std::uint32_t>(up);
  return {row * columns + column % columns, across - column, up - row};
}

// FNV-1a.
std::uint32_t streamOf(const std::string& sensor_label, std::uint32_t purpose) {
  std::uint32_t hash = 2166136261u ^ purpose;
  for (const char c : sensor_label) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash;
}

}  // namespace perception
