#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/AzimuthTable.h"

namespace perception {

/// Water, or loose snow, that vehicles whirl up (method.md 9.4) [linnhoff2022a]: clusters of drops,
/// spheres that the air slows down. Lidar: returns and extinction. Camera: contrast.
class Spray final : public SimulatedWeather {
 public:
  /// Water film [mm] on the road, share [0, 1] of it under snow, wind [m/s, world].
  Spray(double film_mm, double snow_cover, const Vector2& wind, std::uint64_t seed);

  static constexpr double kCycle = 0.1;  ///< [s] clusters are born once a cycle
  /// Mean number of clusters born in a cycle behind a vehicle at `speed` [m/s].
  double born(double speed) const;

  using SimulatedWeather::alter;
  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  bool actsOnPulses() const override { return true; }

  /// A sphere of drops.
  struct Cluster {
    Vector3 position, velocity;  ///< [m], [m/s] world
    double radius, age, life;    ///< [m], [s], [s] time constant
    double detection;            ///< chance of a return when new
    double drag;                 ///< [1/m] < 0
  };
  const std::vector<Cluster>& clusters() const { return clusters_; }

 private:
  void step();
  void emit(const World& world, std::size_t object, double t);

  double film_, offset_kmh_;
  Vector3 wind_;
  std::uint64_t seed_;
  std::int64_t cycle_;  // number of the next one
  std::vector<Cluster> clusters_, shown_;
  AzimuthTable table_;  // of those shown to the sensor of the last advance()
};

}  // namespace perception
