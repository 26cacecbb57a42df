#pragma once
#include "libperception/simulation/weather/particles/ParticleReceiver.h"
#include "libperception/simulation/weather/particles/Snow.h"

namespace perception {

/// Snow whose lidar returns come from single flakes in the beam's plane [hahner2022] (method.md
/// 9.2) instead of the measured law of Snow: a second generator, for validation. Flakes shade what
/// is behind them; echoes of flakes closer than a pulse add up. Its receiver has its own detection
/// threshold for flakes (ParticleReceiver).
class SnowFlakes final : public Snow {
 public:
  SnowFlakes(double mm_h, std::uint64_t seed, const ParticleReceiver& receiver = {});

  using Snow::alter;
  void advance(const World&, const SensorParams&, double) override {}
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override;

 private:
  ParticleReceiver receiver_;
  double diameter_;  // [m] mean
  double per_m2_;    // flakes in the plane of a scan line
  double reach_;     // [m] up to which flakes are drawn
};

}  // namespace perception
