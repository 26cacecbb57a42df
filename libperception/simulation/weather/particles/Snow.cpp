#include "libperception/simulation/weather/particles/Snow.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/particles/FallingParticles.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

constexpr double kReflectivity = 0.9;  // of a flake [hahner2022]
constexpr double kDivergence = 0.003;  // [rad] method.md 9
constexpr double kDetected = 1.0001;   // of the threshold, so that rounding hides no flake
// Large flakes (method.md 9.2, assumed): share of the returns within 5 m, their angular diameter
// (2 to 4 beams of a 64-beam lidar), brightness as the beam is filled.
constexpr double kLargeShare = 0.1, kLargeWithin = 5;            // [m]
constexpr double kSmallestFlake = 0.4, kLargestFlake = 0.6;      // [cells]
constexpr double kLeastBrightness = 0.2, kMostBrightness = 0.6;  // of its reflectivity
constexpr double kSnowCell = radians(1);                         // of directions
constexpr double kHeavy = 2.5, kHeavyRecall = 0.5;               // [mm/h] method.md 9.9
constexpr std::uint32_t kFlakes = 0x57EA1000;                    // purpose of random numbers

// Mean area of a disk whose diameter is uniform between the two.
double meanArea() {
  const double middle = .5 * (kSmallestFlake + kLargestFlake),
               width = kLargestFlake - kSmallestFlake;
  return kPi / 4 * (middle * middle + width * width / 12);
}

// By its power: a surface behind it with a stronger echo hides it.
void addFlake(double range, double intensity, LidarPulse& pulse) {
  if (range >= openRange(pulse)) return;
  LidarPulse::Scatterer flake;
  flake.range = range, flake.power = intensity / (range * range);
  flake.phantom = Phantom::kSnow;
  pulse.scatterers.push_back(flake);
}

}  // namespace

Snow::Snow(double mm_h, std::uint64_t seed, bool by_sizes)
    : mm_h_(mm_h),
      seed_(seed),
      by_sizes_(by_sizes),
      extinction_(snowExtinction(mm_h)),
      chance_(kSnowReturns.chance(mm_h)),
      large_per_cell_(chance_ * kLargeShare * kSnowReturns.shareWithin(kLargeWithin) / meanArea()),
      diameter_(1e-3 / gunnMarshall(mm_h).slope),
      recall_(1 - (1 - kHeavyRecall) * std::min(1.0, mm_h / kHeavy)),
      grid_(kSnowCell),
      large_(grid_.cells()) {}

// A cell holds one large flake or none, a disk that lies within it.
void Snow::advance(const World&, const SensorParams& sensor, double t) {
  if (!sensor.isLidar()) return;
  if (by_sizes_) {
    detectable_ =
        DetectableParticles(gunnMarshall(mm_h_), kDivergence, sensor.lidar.reference_range);
    return;
  }
  const auto tick = static_cast<std::uint64_t>(std::llround(std::max(0.0, t) * 1e6));
  Rng rng({seed_, tick, 0, streamOf(sensor.label, kFlakes)});
  const double across = rng.uniform(), up = rng.uniform();
  grid_.shift(across, up);
  for (LargeFlake& flake : large_) {
    flake.radius = 0;
    if (rng.uniform() >= large_per_cell_) continue;
    flake.radius = .5 * rng.uniform(kSmallestFlake, kLargestFlake);
    flake.across = rng.uniform(flake.radius, 1 - flake.radius);
    flake.up = rng.uniform(flake.radius, 1 - flake.radius);
    do {
      flake.range = kSnowReturns.range(rng);
    } while (flake.range >= kLargeWithin);
    flake.intensity = kReflectivity * rng.uniform(kLeastBrightness, kMostBrightness);
  }
}

void Snow::alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const {
  attenuate(pulse, extinction_);
  if (by_sizes_) return addFlakesBySize(sensor.lidar, pulse, rng);
  addSmallFlake(sensor.lidar, pulse, rng);
  addLargeFlake(pulse);
}

void Snow::addFlakesBySize(const LidarSensorParams& lidar, LidarPulse& pulse, Rng& rng) const {
  const double open = openRange(pulse);
  for (int k = rng.poisson(detectable_.mean); k > 0; --k) {
    const double range = detectable_.range(rng);
    if (range < open) addFlake(range, intensityAt(range, lidar, rng), pulse);
  }
}

// Those that belong to large flakes are left out here. The law is of flakes that are detected: the
// smallest one that is fills range / reference range of the beam's diameter, and how much larger a
// flake is has the distribution of all (exponential).
void Snow::addSmallFlake(const LidarSensorParams& lidar, LidarPulse& pulse, Rng& rng) const {
  if (rng.uniform() >= chance_) return;
  const double range = kSnowReturns.range(rng);
  if (range < kLargeWithin && rng.uniform() < kLargeShare) return;
  addFlake(range, intensityAt(range, lidar, rng), pulse);
}

double Snow::intensityAt(double range, const LidarSensorParams& lidar, Rng& rng) const {
  const double filled = kDetected * range / lidar.reference_range +
                        rng.exponential(diameter_) / (range * kDivergence);
  return kReflectivity * std::min(1.0, filled * filled);
}

void Snow::addLargeFlake(LidarPulse& pulse) const {
  const AimGrid::Place place = grid_.at(pulse.azimuth, pulse.elevation);
  const LargeFlake& large = large_[place.cell];
  if (large.radius <= 0 || large.range >= openRange(pulse) ||
      std::hypot(place.across - large.across, place.up - large.up) > large.radius) {
    return;
  }
  addFlake(large.range, large.intensity, pulse);
}

void Snow::alter(const SensorParams&, CameraLook& look, Rng&) const {
  look.optical_depth += extinction_ * look.range;
  look.chance *= recall_;
}

void Snow::alter(const SensorParams&, Lighting& light, Rng&) const { light.haze += extinction_; }

// A flake is white and dull; by day it has the light of the sky, at night that of the headlights.
void Snow::alter(const SensorParams&, CameraView& view, Rng& rng) const {
  const Lighting light = view.light;
  const auto radiance = [&](const Vector3& direction, double range) {
    const double lamps = light.headlightsOn(direction, range);
    return Rgb(kReflectivity * (light.ambientOn(-direction) + Rgb(lamps, lamps, lamps)));
  };
  drawParticles({flakeSizes(mm_h_), [](double) { return kFlakeSpeed; }, radiance}, view, rng);
}

}  // namespace perception
