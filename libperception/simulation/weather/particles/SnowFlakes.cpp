#include "libperception/simulation/weather/particles/SnowFlakes.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/weather/particles/Precipitation.h"

namespace perception {
namespace {

using Receiver = ParticleReceiver;

constexpr double kFlakePulse = 0.299792458 * 10;  // [m] c times 10 ns [hahner2022]
constexpr double kLargestOfMean = 7;  // diameter up to which flakes set the reach: 999 of 1000

/// A flake in the beam: what it takes of the beam's width, from its right edge.
struct Flake {
  double range;     // [m]
  double from, to;  // [0, 1]
  double power;     // of its visible part, in the unit of the lidar equation
};

// Share of the volume of air (and of any plane in it) that flakes fill [hahner2022].
double occupancy(double mm_h) { return mm_h / (3.6e6 * kFlakeDensity * kFlakeSpeed); }

double reachOf(double mean_diameter, const Receiver& receiver) {
  const double widest = kLargestOfMean * mean_diameter;
  return std::cbrt(receiver.flake_reflectivity * widest /
                   (receiver.divergence * Receiver::kWeakest));
}

/// The part of [0, 1] that nearer flakes shade, as disjoint intervals.
class Shade {
 public:
  /// Covers an interval; returns the length that was open until now.
  double cover(double from, double to) {
    const double before = covered();
    auto first = std::find_if(parts_.begin(), parts_.end(),
                              [&](const auto& part) { return part.second >= from; });
    auto last = first;
    for (; last != parts_.end() && last->first <= to; ++last)
      from = std::min(from, last->first), to = std::max(to, last->second);
    first = parts_.erase(first, last);
    parts_.insert(first, {from, to});
    return covered() - before;
  }
  double covered() const {
    double sum = 0;
    for (const auto& [from, to] : parts_) sum += to - from;
    return sum;
  }

 private:
  std::vector<std::pair<double, double>> parts_;  // ascending
};

// Power received at the peak of flake `k`: its own, and of those whose pulses reach there; sin^2 of
// the pulse's length.
double peakAt(const std::vector<Flake>& flakes, std::size_t k) {
  double sum = 0;
  for (const Flake& other : flakes) {
    const double off = std::abs(other.range - flakes[k].range) / kFlakePulse;
    if (off >= .5) continue;
    const double shape = std::cos(kPi * off);
    sum += other.power * shape * shape;
  }
  return sum;
}

}  // namespace

// The plane holds as many flakes as fill the occupancy: the mean area of a disk whose diameter is
// exponential of mean d is pi/2 d^2.
SnowFlakes::SnowFlakes(double mm_h, std::uint64_t seed, const ParticleReceiver& receiver)
    : Snow(mm_h, seed),
      receiver_(receiver),
      diameter_(1e-3 / gunnMarshall(mm_h).slope),
      per_m2_(occupancy(mm_h) / (kPi / 2 * diameter_ * diameter_)),
      reach_(reachOf(diameter_, receiver)) {}

void SnowFlakes::alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const {
  const double open = openRange(pulse), far = std::min(open, reach_);
  std::vector<Flake> flakes(
      static_cast<std::size_t>(rng.poisson(per_m2_ * far * receiver_.beamWidth(far) / 2)));
  for (Flake& flake : flakes) {
    flake.range = far * std::sqrt(rng.uniform());
    const double width = rng.exponential(diameter_) / receiver_.beamWidth(flake.range);
    const double middle = rng.uniform();
    flake.from = std::max(0.0, middle - width / 2), flake.to = std::min(1.0, middle + width / 2);
  }
  std::sort(flakes.begin(), flakes.end(),
            [](const Flake& a, const Flake& b) { return a.range < b.range; });
  Shade shade;
  for (Flake& flake : flakes) {
    const double seen = shade.cover(flake.from, flake.to);
    flake.power = flake.range < Receiver::kNearest
                      ? 0
                      : receiver_.flake_reflectivity * seen / (flake.range * flake.range);
  }
  // What is behind keeps the open part of the beam; beyond the reach flakes shade by their mean.
  pulse.reflectivity *= 1 - shade.covered();
  if (open > far && pulse.hit.object != BeamHit::kNothing)
    pulse.optical_depth += .5 * per_m2_ * diameter_ * (open - far);
  for (std::size_t k = 0; k < flakes.size(); ++k) {
    if (flakes[k].power <= 0) continue;
    LidarPulse::Scatterer flake;
    flake.range = flakes[k].range, flake.power = peakAt(flakes, k);
    flake.phantom = Phantom::kSnow;
    if (flake.power >= Receiver::kWeakest) pulse.scatterers.push_back(flake);
  }
}

}  // namespace perception
