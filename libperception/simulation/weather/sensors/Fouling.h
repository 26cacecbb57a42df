#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/Beam.h"

namespace perception {

/// Dirt or water on the sensors' windows (method.md 9.9): patches of directions in which a lidar
/// has no returns and a camera sees badly; loss of power in the radome of a radar.
class Fouling final : public SimulatedWeather {
 public:
  /// `share` [0, 1] of a window under dirt; `radome_db` [dB] one way.
  Fouling(double share, double radome_db, std::uint64_t seed);

  using SimulatedWeather::alter;
  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams&, LidarPulse& pulse, Rng&) const override;
  void alter(const SensorParams&, RadarReflection& reflection, Rng&) const override;
  void alter(const SensorParams&, RadarAir& air, Rng&) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  bool actsOnPulses() const override { return share_ > 0; }

 private:
  double share_, radome_;  // radome: factor on the power, both ways
  std::uint64_t seed_;
  // Of the sensor of the last advance():
  double yaw_ = 0;  // [rad] world
  AimGrid grid_;
  std::vector<char> dirty_;  // cells
};

}  // namespace perception
