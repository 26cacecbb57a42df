#include "libperception/simulation/weather/particles/RainDrops.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/Beam.h"

namespace perception {
namespace {

using Receiver = ParticleReceiver;

constexpr double kSmallestDrop = 0.05,
                 kLargestDrop = 8;  // [mm] drops: counted from; larger ones break up
constexpr double kIndex = 1.328;    // of water at 905 nm, method.md 9.1

// At normal incidence [kilic2021].
double reflectance() {
  const double r = (kIndex - 1) / (kIndex + 1);
  return r * r;
}

// Echo of a drop of diameter [m] in the unit of the lidar equation, without extinction.
double echoOfDrop(double diameter, double range, const Receiver& receiver) {
  const double filled = std::min(1.0, diameter / receiver.beamWidth(range));
  return reflectance() * filled * filled / (range * range);
}

// Where the largest drop is at the threshold.
double reachOfDrops(const Receiver& receiver) {
  const double strength = reflectance() / Receiver::kWeakest;
  return std::sqrt(std::sqrt(strength) * 1e-3 * kLargestDrop / receiver.divergence);
}

}  // namespace

RainDrops::RainDrops(double mm_h, std::uint64_t seed, const ParticleReceiver& receiver)
    : Rain(mm_h, seed),
      receiver_(receiver),
      sizes_(marshallPalmer(mm_h)),
      per_m3_(sizes_.number * std::exp(-sizes_.slope * kSmallestDrop) / sizes_.slope),
      reach_(reachOfDrops(receiver)),
      opacity_(rainExtinction(mm_h)) {}

// Drops beyond the reach, or below the threshold, are not received whatever is behind them; they
// count in the extinction alone.
void RainDrops::alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const {
  attenuate(pulse, opacity_);
  const double far = std::min(openRange(pulse), reach_);
  if (far <= Receiver::kNearest) return;
  const double radius = receiver_.beamWidth(far) / 2;
  const int drops = rng.poisson(per_m3_ * kPi / 3 * far * radius * radius);
  for (int k = 0; k < drops; ++k) {
    LidarPulse::Scatterer drop;
    drop.range = far * std::cbrt(rng.uniform());
    const double diameter = 1e-3 * (kSmallestDrop + rng.exponential(1 / sizes_.slope));
    if (drop.range < Receiver::kNearest) continue;
    drop.power = echoOfDrop(diameter, drop.range, receiver_) * std::exp(-2 * opacity_ * drop.range);
    if (drop.power < Receiver::kWeakest) continue;
    drop.phantom = Phantom::kRain;
    pulse.scatterers.push_back(drop);
  }
}

}  // namespace perception
