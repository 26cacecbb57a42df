#include "libperception/simulation/LidarEcho.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

bool inReach(const LidarPulse::Scatterer& s, const LidarParams& p) {
  return s.range >= p.range_min && s.range <= p.range_max;
}

// The nearest scatterer of known intensity; null where there is none.
const LidarPulse::Scatterer* knownReturn(const LidarPulse& pulse, const LidarParams& p) {
  const LidarPulse::Scatterer* first = nullptr;
  for (const LidarPulse::Scatterer& s : pulse.scatterers) {
    if (s.intensity < 0 || !inReach(s, p)) continue;
    if (!first || s.range < first->range) first = &s;
  }
  return first;
}

}  // namespace

LidarEcho echoOf(const LidarPulse& pulse, double reflectivity, const LidarParams& p) {
  LidarEcho echo;
  if (pulse.blocked) return echo;
  if (const LidarPulse::Scatterer* known = knownReturn(pulse, p)) {
    echo.received = true;
    echo.range = known->range, echo.intensity = known->intensity, echo.phantom = known->phantom;
    return echo;
  }
  double returned = 0;
  if (pulse.hit.object != BeamHit::kNothing && pulse.hit.range >= p.range_min && reflectivity > 0) {
    returned = reflectivity;
    if (pulse.optical_depth > 0) returned *= std::exp(-2 * pulse.optical_depth);
    echo.of_surface = true;
    echo.range = pulse.hit.range;
  }
  for (const LidarPulse::Scatterer& s : pulse.scatterers) {
    if (!inReach(s, p)) continue;
    if (returned > 0 && s.power * echo.range * echo.range <= returned) continue;
    echo.range = s.range, returned = s.power * s.range * s.range;
    echo.of_surface = false, echo.phantom = s.phantom;
  }
  if (!(returned > 0)) return echo;
  const double far = p.reference_range / echo.range;
  echo.snr = returned / (0.9 * pulse.threshold) * far * far;
  echo.received = echo.snr >= 1;
  echo.intensity = std::min(1.0, returned);
  return echo;
}

}  // namespace perception
