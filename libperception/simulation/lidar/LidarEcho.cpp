#include "libperception/simulation/lidar/LidarEcho.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// Ratio of an echo's power to the threshold, method.md (57).
double ratioOf(double intensity, double range, const LidarPulse& pulse,
               const LidarSensorParams& p) {
  const double far = p.reference_range / range;
  return intensity / (0.9 * pulse.threshold) * far * far;
}

bool inReach(const LidarPulse::Scatterer& s, const LidarSensorParams& p) {
  return s.range >= p.range_min && s.range <= p.range_max;
}

// The nearest scatterer of known intensity; null where there is none.
const LidarPulse::Scatterer* knownReturn(const LidarPulse& pulse, const LidarSensorParams& p) {
  const LidarPulse::Scatterer* first = nullptr;
  for (const LidarPulse::Scatterer& s : pulse.scatterers) {
    if (s.intensity < 0 || !inReach(s, p)) continue;
    if (!first || s.range < first->range) first = &s;
  }
  return first;
}

}  // namespace

LidarEcho echoOf(const LidarPulse& pulse, double reflectivity, const LidarSensorParams& p) {
  LidarEcho echo;
  if (pulse.blocked) return echo;
  if (const LidarPulse::Scatterer* known = knownReturn(pulse, p)) {
    echo.received = true;
    echo.range = known->range, echo.intensity = known->intensity, echo.phantom = known->phantom;
    // Reported in steps; it was received, so it is at least at the threshold.
    const double dimmest = .5 / 255;
    echo.level = std::max(1.0, ratioOf(std::max(dimmest, echo.intensity), echo.range, pulse, p));
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
  echo.snr = echo.level = ratioOf(returned, echo.range, pulse, p);
  echo.received = echo.snr >= 1;
  echo.intensity = std::min(1.0, returned);
  return echo;
}

std::optional<LidarEcho> secondEchoOf(const LidarPulse& pulse, const LidarEcho& first,
                                      double reflectivity, const LidarSensorParams& p) {
  constexpr double kApart = 0.75;  // [m] 5 ns there and back
  if (!first.received || first.of_surface || pulse.hit.object == BeamHit::kNothing) return {};
  LidarPulse open = pulse;
  open.scatterers.clear();
  const LidarEcho second = echoOf(open, reflectivity, p);
  if (!second.received || second.range < first.range + kApart) return {};
  return second;
}

// A Gaussian pulse of 4 ns at half its height, 0.6 m, widened by the surface's depth (assumed).
double pulseWidth(double snr, double slant) {
  constexpr double kHalfHeight = 0.6;  // [m]
  const double sigma =
      std::hypot(kHalfHeight / std::sqrt(8 * std::log(2.0)), slant / std::sqrt(12));
  return 2 * sigma * std::sqrt(2 * std::log(std::max(1.0, snr)));
}

bool isRain(const LidarEcho& first, const LidarEcho& second) {
  return first.level < second.level || first.width < second.width;
}

}  // namespace perception
