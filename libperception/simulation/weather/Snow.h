#pragma once
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// Falling snow (method.md 9.2, 9.9). Lidar: extinction by the flakes' sizes, false returns by the
/// measured law [linnhoff2022]; some of those within 5 m are large flakes that neighboring beams
/// see together, as bright as objects. Camera: contrast, lost edges, haze. Radar: dry snow
/// attenuates too little to matter at these ranges.
class Snow final : public SimulatedWeather {
 public:
  Snow(double mm_h, std::uint64_t seed);

  using SimulatedWeather::alter;
  void advance(const World&, const SensorParams&, double t) override;
  void alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  void alter(const SensorParams&, Lighting& light, Rng&) const override;
  bool actsOnPulses() const override { return true; }

 private:
  void addSmallFlake(LidarPulse& pulse, Rng& rng) const;
  void addLargeFlake(const SensorParams& sensor, LidarPulse& pulse) const;

  std::uint64_t seed_;
  std::uint64_t tick_ = 0;                  // [us] of the observation
  double shift_across_ = 0, shift_up_ = 0;  // of the cells of directions
  double extinction_;                       // [1/m]
  double chance_;                           // of a false return, a beam
  double large_per_cell_;                   // mean number of large flakes in a cell of directions
  double diameter_;                         // [m] mean of the small flakes
  double recall_;                           // camera: share that is left
};

}  // namespace perception
