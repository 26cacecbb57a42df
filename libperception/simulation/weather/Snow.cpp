#include "libperception/simulation/weather/Snow.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/simulation/Scenario.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/weather/Precipitation.h"

namespace perception {
namespace {

constexpr double kReflectivity = 0.9;  // of a flake [hahner2022]
constexpr double kDivergence = 0.003;  // [rad] method.md 9
// Large flakes (method.md 9.2, assumed): share of the returns within 5 m, their angular diameter
// (2 to 4 beams of a 64-beam lidar), brightness as the beam is filled.
constexpr double kLargeShare = 0.3, kLargeWithin = 5;               // [m]
constexpr double kSmallest = 0.4, kLargest = 0.6;                   // [cells]
constexpr double kLeastBrightness = 0.2, kMostBrightness = 0.6;     // of its reflectivity
constexpr double kCell = radians(1);                                // of directions
constexpr double kHeavy = 2.5, kHeavyRecall = 0.5;                  // [mm/h] method.md 9.9
constexpr std::uint32_t kFlakes = 0x57EA1000, kShift = 0x57EA1001;  // purposes of random numbers

// Mean area of a disk whose diameter is uniform between the two.
double meanArea() {
  const double middle = .5 * (kSmallest + kLargest), width = kLargest - kSmallest;
  return kPi / 4 * (middle * middle + width * width / 12);
}

}  // namespace

Snow::Snow(double mm_h, std::uint64_t seed)
    : seed_(seed),
      extinction_(snowExtinction(mm_h)),
      chance_(kSnowReturns.chance(mm_h)),
      large_per_cell_(chance_ * kLargeShare * kSnowReturns.shareWithin(kLargeWithin) / meanArea()),
      diameter_(1e-3 / gunnMarshall(mm_h).slope),
      recall_(1 - (1 - kHeavyRecall) * std::min(1.0, mm_h / kHeavy)) {}

void Snow::advance(const World&, const SensorParams&, double t) {
  tick_ = static_cast<std::uint64_t>(std::llround(std::max(0.0, t) * 1e6));
  Rng rng({seed_, tick_, 0, kShift});
  shift_across_ = rng.uniform(), shift_up_ = rng.uniform();
}

void Snow::alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const {
  attenuate(pulse, extinction_);
  addSmallFlake(pulse, rng);
  addLargeFlake(sensor, pulse);
}

// Those that belong to large flakes are left out here.
void Snow::addSmallFlake(LidarPulse& pulse, Rng& rng) const {
  if (rng.uniform() >= chance_) return;
  LidarPulse::Scatterer flake;
  flake.range = kSnowReturns.range(rng);
  if (flake.range < kLargeWithin && rng.uniform() < kLargeShare) return;
  const double filled = rng.exponential(diameter_) / (flake.range * kDivergence);
  flake.intensity = kReflectivity * std::min(1.0, filled * filled);
  flake.phantom = Phantom::kSnow;
  if (flake.range < openRange(pulse)) pulse.scatterers.push_back(flake);
}

// A cell holds one flake or none, a disk that lies within it.
void Snow::addLargeFlake(const SensorParams& sensor, LidarPulse& pulse) const {
  const AimCell cell = aimCell(pulse.aim, kCell, shift_across_, shift_up_);
  Rng rng({seed_, tick_, cell.index, streamOf(sensor.label, kFlakes)});
  if (rng.uniform() >= large_per_cell_) return;
  const double radius = .5 * rng.uniform(kSmallest, kLargest);
  const double across = rng.uniform(radius, 1 - radius), up = rng.uniform(radius, 1 - radius);
  if (std::hypot(cell.across - across, cell.up - up) > radius) return;
  LidarPulse::Scatterer flake;
  do {
    flake.range = kSnowReturns.range(rng);
  } while (flake.range >= kLargeWithin);
  flake.intensity = kReflectivity * rng.uniform(kLeastBrightness, kMostBrightness);
  flake.phantom = Phantom::kSnow;
  if (flake.range < openRange(pulse)) pulse.scatterers.push_back(flake);
}

void Snow::alter(const SensorParams&, CameraLook& look, Rng&) const {
  look.optical_depth += extinction_ * look.range;
  look.chance *= recall_;
}

void Snow::alter(const SensorParams&, Lighting& light, Rng&) const { light.haze += extinction_; }

}  // namespace perception
