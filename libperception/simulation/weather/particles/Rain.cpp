#include "libperception/simulation/weather/particles/Rain.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/weather/particles/FallingParticles.h"
#include "libperception/simulation/weather/particles/Precipitation.h"
#include "libperception/simulation/weather/sensors/FalseBoxes.h"
#include "libperception/simulation/weather/sensors/LensDrops.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

constexpr double kMeanIntensity = 0.693;  // of false returns, of 255; Poisson [linnhoff2022]
// Box edges in rain (method.md 9.9, assumed): 1.5 times the noise from this rate on.
constexpr double kEdgeNoise = 1.5, kEdgeRate = 10;
// The rate of [radecki2016]'s rainy precision is not known (assumed).
constexpr double kWetRate = 10;
// Drops on the lens: blurred share of the image in the lightest and from the heaviest rain on, and
// what is found behind them (method.md 9.9, assumed).
constexpr double kLeastDrops = 0.05, kMostDrops = 0.15, kMostDropsRate = 50,
                 kRainBlurredRecall = 0.5;

constexpr double kWiped = 1;                         // [s] drops on the lens stay (assumed)
constexpr std::uint32_t kDropsPurpose = 0x57EA3000;  // of random numbers
constexpr double kDropRadiance = 0.94;               // of the mean of what is around [garg2007]

}  // namespace

Rain::Rain(double mm_h, std::uint64_t seed)
    : mm_h_(mm_h),
      seed_(seed),
      extinction_(rainExtinction(mm_h)),
      chance_(kRainReturns.chance(mm_h)),
      attenuation_(radarAttenuation(mm_h)),
      backscatter_(radarBackscatter(mm_h)),
      drops_(kLeastDrops + (kMostDrops - kLeastDrops) * std::min(1.0, mm_h / kMostDropsRate)),
      wetness_(std::min(1.0, mm_h / kWetRate)),
      edge_noise_(1 + (kEdgeNoise - 1) * std::min(1.0, mm_h / kEdgeRate)) {}

void Rain::advance(const World&, const SensorParams&, double t) {
  wiped_ = static_cast<std::uint64_t>(std::max(0.0, t) / kWiped);
}

void Rain::alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const {
  attenuate(pulse, extinction_);
  if (rng.uniform() >= chance_) return;
  LidarPulse::Scatterer drop;
  drop.range = kRainReturns.range(rng);
  drop.intensity = std::min(255, rng.poisson(kMeanIntensity)) / 255.0;
  drop.phantom = Phantom::kRain;
  if (drop.range < openRange(pulse)) pulse.scatterers.push_back(drop);
}

void Rain::alter(const SensorParams&, RadarReflection& reflection, Rng&) const {
  reflection.snr *= std::pow(10, -.1 * 2 * attenuation_ * reflection.range / 1000);
}

void Rain::alter(const SensorParams&, RadarAir& air, Rng&) const {
  air.backscatter += backscatter_;
}

void Rain::alter(const SensorParams&, CameraLook& look, Rng& rng) const {
  look.optical_depth += extinction_ * look.range;
  look.edge_noise *= edge_noise_;
  if (rng.uniform() < drops_) look.chance *= kRainBlurredRecall;
}

void Rain::alter(const SensorParams&, SensorFrame& frame, Rng& rng) const {
  addFalseBoxes(wetness_, frame, rng);
}

void Rain::alter(const SensorParams&, Lighting& light, Rng&) const { light.haze += extinction_; }

// A drop shows all that is before the camera, upside down: half sky, half ground.
void Rain::alter(const SensorParams& sensor, CameraView& view, Rng& rng) const {
  const Lighting& light = view.light;
  const Rgb around =
      .5 * kDropRadiance * (light.sky(Vector3::UnitX()) + light.ambientOn(-Vector3::UnitZ()));
  drawParticles({marshallPalmer(mm_h_), dropSpeed, [&](const Vector3&, double) { return around; }},
                view, rng);
  Rng drops({seed_, wiped_, 0, streamOf(sensor.label, kDropsPurpose)});
  addLensDrops(drops_, view, drops);
}

}  // namespace perception
