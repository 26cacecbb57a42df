#pragma once
#include "libperception/simulation/weather/particles/ParticleReceiver.h"
#include "libperception/simulation/weather/particles/Precipitation.h"
#include "libperception/simulation/weather/particles/Rain.h"

namespace perception {

/// Rain whose lidar returns come from single drops in the beam's cone [kilic2021] (method.md 9.1)
/// instead of the measured law of Rain: a second generator, for validation. Its receiver has its
/// own detection threshold for drops (ParticleReceiver).
class RainDrops final : public Rain {
 public:
  explicit RainDrops(double mm_h, std::uint64_t seed = 0, const ParticleReceiver& receiver = {});

  using Rain::alter;
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override;

 private:
  ParticleReceiver receiver_;
  SizeDistribution sizes_;
  double per_m3_;   // drops of the smallest diameter and larger
  double reach_;    // [m] beyond it no drop is received
  double opacity_;  // [1/m]
};

}  // namespace perception
