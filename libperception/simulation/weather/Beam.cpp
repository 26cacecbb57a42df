#include "libperception/simulation/weather/Beam.h"

#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"

namespace perception {

double openRange(const LidarPulse& pulse) {
  return pulse.hit.object == BeamHit::kNothing ? std::numeric_limits<double>::infinity()
                                               : static_cast<double>(pulse.hit.range);
}

void attenuate(LidarPulse& pulse, double extinction) {
  if (pulse.hit.object != BeamHit::kNothing) pulse.optical_depth += extinction * pulse.hit.range;
}

AimGrid::AimGrid(double size)
    : size_(size),
      columns_(static_cast<std::size_t>(std::lround(kTwoPi / size))),
      rows_(columns_ / 2 + 2) {}

AimGrid::Place AimGrid::at(double azimuth, double elevation) const {
  const double across = (azimuth + kTwoPi) / size_ + across_,
               up = (elevation + kPi / 2) / size_ + up_;
  const auto column = static_cast<std::size_t>(across), row = static_cast<std::size_t>(up);
  return {row * columns_ + column % columns_, across - static_cast<double>(column),
          up - static_cast<double>(row)};
}

// FNV-1a.
std::uint32_t streamOf(const std::string& sensor_label, std::uint32_t purpose) {
  std::uint32_t hash = 2166136261u ^ purpose;
  for (const char c : sensor_label) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash;
}

}  // namespace perception
