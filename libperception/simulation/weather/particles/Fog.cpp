#include "libperception/simulation/weather/particles/Fog.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

constexpr double kFogStep = 0.1;                // [m] of ranges
constexpr double kFarthest = 60;                // [m] of the table; the peak lies below 10 m
constexpr double kPulse = 0.299792458 * 20;     // [m] c times 20 ns
constexpr double kBlind = 0.9, kOverlap = 1.0;  // [m] the receiver sees nothing; all
// Assumed: a lidar whose weakest echo is a 90 % surface at 200 m just sees fog of this range of
// sight by itself. [hahner2021] leaves the ratio of fog and surfaces to calibration.
constexpr double kSeenMor = 100, kWeakest = 0.9 / (200.0 * 200);

constexpr double kFaintFog = 0.2;  // of the surface's echo

double backscatter(double mor) { return 0.046 / mor; }  // [1/(m sr)] [rasshofer2011]

double overlap(double range) {
  return std::clamp((range - kBlind) / (kOverlap - kBlind), 0.0, 1.0);
}

// Integral over the pulse's length of its power, sin^2, times the echo of fog at range - x.
double echoAt(double range, double extinction) {
  const double end = std::min(kPulse, range - kBlind);
  if (end <= 0) return 0;
  const int steps = std::max(2, static_cast<int>(std::ceil(end / 0.02)));
  const double dx = end / steps;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double x = (i + .5) * dx, r = range - x, pulse = std::sin(kPi * x / kPulse);
    sum += pulse * pulse * std::exp(-2 * extinction * r) / (r * r) * overlap(r);
  }
  return sum * dx;
}

}  // namespace

double fogExtinction(double mor) { return std::log(20.0) / mor; }

FogEcho::FogEcho(double extinction) {
  Peak best;
  for (int i = 0; i * kFogStep <= kFarthest; ++i) {
    const double range = i * kFogStep, value = echoAt(range, extinction);
    if (value > best.value) best = {range, value};
    peaks_.push_back(best);
  }
}

FogEcho::Peak FogEcho::before(double surface_range) const {
  const double last = static_cast<double>(peaks_.size() - 1);
  return peaks_[static_cast<std::size_t>(std::clamp(surface_range / kFogStep, 0.0, last))];
}

Fog::Fog(double mor) : extinction_(fogExtinction(mor)), echo_(extinction_) {
  const FogEcho seen(fogExtinction(kSeenMor));
  const double far = std::numeric_limits<double>::infinity();
  gain_ = backscatter(mor) * kWeakest / (backscatter(kSeenMor) * seen.before(far).value);
}

// Echoes that no threshold passes, or that are weak beside the surface's, are not made: most. The
// peak's range is spread by a factor of 1/2 to 2 [hahner2021], up to the surface.
void Fog::alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const {
  attenuate(pulse, extinction_);
  const double open = openRange(pulse);
  const FogEcho::Peak peak = echo_.before(open);
  const double power = gain_ * peak.value, far = sensor.lidar.reference_range;
  if (peak.value <= 0 || power < 0.9 / (far * far)) return;
  const double surface = std::isinf(open) ? 0 : pulse.reflectivity / (open * open);
  if (pulse.lost <= 0 && power < kFaintFog * surface * std::exp(-2 * pulse.optical_depth)) return;
  LidarPulse::Scatterer fog;
  fog.range = std::min(open, peak.range * std::exp2(rng.uniform(-1, 1)));
  fog.power = power;
  fog.phantom = Phantom::kFog;
  pulse.scatterers.push_back(fog);
}

void Fog::alter(const SensorParams&, CameraLook& look, Rng&) const {
  look.optical_depth += extinction_ * look.range;
}

void Fog::alter(const SensorParams&, Lighting& light, Rng&) const { light.haze += extinction_; }

}  // namespace perception
