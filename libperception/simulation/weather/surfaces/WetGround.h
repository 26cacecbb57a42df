#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/AzimuthTable.h"

namespace perception {

/// A film of water on the road (method.md 9.7). Lidar: weak echoes of the ground and, as the film
/// is a mirror, ghosts: echoes over the ground's reflection.
class WetGround final : public SimulatedWeather {
 public:
  /// `object_factor` on the reflectivity of what is mirrored: objects are wet, too.
  explicit WetGround(double film_mm, double object_factor = 1);

  using SimulatedWeather::alter;
  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams& sensor, LidarPulse& pulse, Rng&) const override;
  bool actsOnPulses() const override { return true; }

 private:
  /// What stands in a direction.
  struct Stander {
    double near, height;  // [m] from the sensor, above the road
  };
  bool mayMeet(const Vector3& ground, const Vector3& direction, double traveled) const;
  void addMirrored(const SensorParams& sensor, double mirror, LidarPulse& pulse) const;
  void blend(LidarPulse& pulse) const;

  double wet_;  // [0, 1] share of the road
  double object_factor_;
  std::vector<Stander> standers_;
  AzimuthTable table_;
};

}  // namespace perception
