#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/AzimuthTable.h"

namespace perception {

/// Exhaust that condenses in cold or damp air behind vehicles under way, also while they stand
/// (method.md 9.5): Gaussian puffs that grow, rise and drift. Acts on lidars.
class Plume final : public SimulatedWeather {
 public:
  Plume(const Vector2& wind, std::uint64_t seed);  ///< [m/s] world

  /// Puffs at one instant.
  struct Puff {
    Vector3 place;      ///< [m] world
    double sigma;       ///< [m]
    double extinction;  ///< [1/m] in its middle
  };
  const std::vector<Puff>& puffs() const { return puffs_; }

  using SimulatedWeather::alter;
  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override;
  bool actsOnPulses() const override { return true; }

 private:
  /// The puffs of one vehicle and a sphere about them.
  struct Cloud {
    std::size_t from, to;  // of puffs_
    Vector3 center;        // [m] world
    double radius;         // [m]
  };
  void addPuffs(const World& world, std::size_t object, double t);

  Vector3 wind_;
  std::uint64_t seed_;
  std::vector<Puff> puffs_;
  std::vector<Cloud> clouds_;
  AzimuthTable table_;  // of clouds
};

}  // namespace perception
