#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// [1/m] of fog through which one sees `mor` [m]: contrast 5 % there (method.md 9.3).
double fogExtinction(double mor);

/// The echo of uniform fog before a surface (method.md 9.3): where a 20 ns pulse's convolution
/// with the fog is strongest, tabulated by the range of the surface.
class FogEcho {
 public:
  explicit FogEcho(double extinction);  ///< [1/m]

  /// Strongest echo before a surface at some range.
  struct Peak {
    double range = 0;  ///< [m]
    double value = 0;  ///< [1/m] of the integral; times backscatter: a share of the pulse
  };
  Peak before(double surface_range) const;  ///< [m]; may be infinite

 private:
  std::vector<Peak> peaks_;  // by kStep of the surface's range
};

/// Fog (method.md 9.3): attenuates echoes and contrast; its own echo near by replaces weaker ones.
class Fog final : public SimulatedWeather {
 public:
  explicit Fog(double mor);  ///< [m]

  using SimulatedWeather::alter;
  void alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  void alter(const SensorParams&, Lighting& light, Rng&) const override;
  bool actsOnPulses() const override { return true; }

 private:
  double extinction_;  // [1/m]
  double gain_;        // power of an echo of value 1, in the unit of the lidar equation
  FogEcho echo_;
};

}  // namespace perception
