#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/weather/particles/Precipitation.h"

namespace perception {

struct LidarSensorParams;

/// Falling snow (method.md 9.2, 9.9). Lidar: extinction by the flakes' sizes, false returns by the
/// measured law [linnhoff2022]; some of those within 5 m are large flakes that neighboring beams
/// see together, as bright as objects. Or returns of all flakes that the lidar detects. Camera:
/// contrast, lost edges, haze, flakes. Radar: dry snow attenuates too little to matter at these
/// ranges.
class Snow : public SimulatedWeather {
 public:
  /// `by_sizes`: lidar returns by the flakes' sizes in place of the measured law.
  Snow(double mm_h, std::uint64_t seed, bool by_sizes = false);

  using SimulatedWeather::alter;
  void advance(const World&, const SensorParams& sensor, double t) override;
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  void alter(const SensorParams&, Lighting& light, Rng&) const override;
  void alter(const SensorParams&, CameraView& view, Rng& rng) const override;
  bool actsOnPulses() const override { return true; }

 private:
  void addSmallFlake(const LidarSensorParams& lidar, LidarPulse& pulse, Rng& rng) const;
  double intensityAt(double range, const LidarSensorParams& lidar, Rng& rng) const;
  void addFlakesBySize(const LidarSensorParams& lidar, LidarPulse& pulse, Rng& rng) const;
  void addLargeFlake(LidarPulse& pulse) const;

  /// A flake that several beams see: a disk in a cell of directions.
  struct LargeFlake {
    double across, up, radius;  // [cells]; radius 0: none
    double range, intensity;    // [m], [0, 1]
  };

  double mm_h_;
  std::uint64_t seed_;
  bool by_sizes_;
  double extinction_;      // [1/m]
  double chance_;          // of a false return, a beam
  double large_per_cell_;  // mean number of large flakes in a cell of directions
  double diameter_;        // [m] mean of the small flakes
  double recall_;          // camera: share that is left
  // By sizes, for the sensor of the last advance().
  DetectableParticles detectable_;
  AimGrid grid_;
  std::vector<LargeFlake> large_;  // by cell, for the sensor of the last advance()
};

}  // namespace perception
