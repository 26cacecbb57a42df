#pragma once
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// Falling rain (method.md 9.1, 9.8, 9.9). Lidar: extinction by the drops' sizes, false returns by
/// the measured law [linnhoff2022]; RainDrops draws single drops instead. Radar: attenuation,
/// clutter of the drops. Camera: contrast, edges, haze, streaks, drops on the lens.
class Rain : public SimulatedWeather {
 public:
  explicit Rain(double mm_h, std::uint64_t seed = 0);

  using SimulatedWeather::alter;
  void advance(const World&, const SensorParams&, double t) override;
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams&, RadarReflection& reflection, Rng&) const override;
  void alter(const SensorParams&, RadarAir& air, Rng&) const override;
  void alter(const SensorParams&, CameraLook& look, Rng& rng) const override;
  void alter(const SensorParams&, SensorFrame& frame, Rng& rng) const override;
  void alter(const SensorParams&, Lighting& light, Rng&) const override;
  void alter(const SensorParams& sensor, CameraView& view, Rng& rng) const override;
  bool actsOnPulses() const override { return true; }

 private:
  double mm_h_;
  std::uint64_t seed_;
  std::uint64_t wiped_ = 0;  // times until the last advance()
  double extinction_;        // [1/m]
  double chance_;            // of a false return, a beam
  double attenuation_;       // [dB/km] one way
  double backscatter_;       // [1/m] of a radar's power
  double drops_;             // blurred share of an image
  double wetness_;           // share of the false boxes of heavy rain
  double edge_noise_;        // factor
};

}  // namespace perception
