#include "libperception/simulation/RadarClutter.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// method.md 9.8, assumed.
constexpr double kElevation = radians(5);  // width of the beam, half power
constexpr double kEqualized = 20;  // [m] nearer echoes are attenuated to what they are from there
constexpr double kSpread = 1;      // [m/s] standard deviation of the drops' range rates
constexpr double kRates = 5;       // cells of range rate that share the power: sqrt(2 pi) / 0.5
constexpr double kFaint = 0.05;    // ratio below which P_D is that of noise

// Volume of a cell [m^3] of a beam of Gaussian section, both ways [probertjones1962].
double cellVolume(double range) {
  return kPi / (8 * std::log(2.0)) * range * range * RadarCell::kBearing * kElevation *
         RadarCell::kRange;
}

}  // namespace

double clutterRatio(const RadarAir& air, double range, const RadarUnitParams& p) {
  const double cross_section = air.backscatter * cellVolume(range) / kRates;
  return air.passing * cross_section / kCarSection * carSnr(std::max(range, kEqualized), p);
}

std::vector<RadarReflection> radarClutter(const RadarAir& air, const RadarUnitParams& p,
                                          const RadarMount& mount, Rng& rng) {
  std::vector<RadarReflection> found;
  if (!(air.backscatter > 0)) return found;
  const int bearings = std::max(1, static_cast<int>(std::round(p.fov / RadarCell::kBearing)));
  const double width = p.fov / bearings, axis = yawOf(mount.T_world_sensor);
  for (double range = p.range_min + .5 * RadarCell::kRange; range < p.range_max;
       range += RadarCell::kRange) {
    const double mean = clutterRatio(air, range, p);
    if (mean < kFaint && range > kEqualized) break;
    const double chance = std::pow(p.false_alarm, 1 / (1 + mean));
    for (int n = rng.poisson(bearings * kRates * chance); n > 0; --n) {
      RadarReflection r;
      r.range = range + rng.uniform(-.5, .5) * RadarCell::kRange;
      r.bearing = width * (static_cast<double>(rng.below(static_cast<std::uint32_t>(bearings))) +
                           .5 - .5 * bearings);
      const double direction = axis + r.bearing;
      const Vector2 sight(std::cos(direction), std::sin(direction));
      r.position = mount.T_world_sensor.translation().head<2>() + r.range * sight;
      r.range_rate = kSpread * rng.normal() - mount.velocity.dot(sight);
      // Exponential power that exceeds the threshold: the threshold and an exponential excess.
      r.snr = -std::log(p.false_alarm) + (1 + mean) * rng.exponential(1);
      found.push_back(r);
    }
  }
  return found;
}

}  // namespace perception
