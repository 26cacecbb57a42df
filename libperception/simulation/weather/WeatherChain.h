#pragma once
#include <memory>
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/SimulatedWeatherParams.h"

namespace perception {

struct Scenario;

/// Several phenomena, one after the other.
class WeatherChain final : public SimulatedWeather {
 public:
  explicit WeatherChain(std::vector<std::unique_ptr<SimulatedWeather>> phenomena);

  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams& sensor, RadarReflection& reflection, Rng& rng) const override;
  void alter(const SensorParams& sensor, RadarAir& air, Rng& rng) const override;
  void alter(const SensorParams& sensor, CameraLook& look, Rng& rng) const override;
  void alter(const SensorParams& sensor, Lighting& light, Rng& rng) const override;
  void alter(const SensorParams& sensor, CameraView& view, Rng& rng) const override;
  void alter(const SensorParams& sensor, SensorFrame& frame, Rng& rng) const override;
  bool actsOnPulses() const override { return !on_pulses_.empty(); }

 private:
  std::vector<std::unique_ptr<SimulatedWeather>> phenomena_;
  std::vector<const SimulatedWeather*> on_pulses_;
};

/// All phenomena that `params` sets; null: clear air. `seed` of the run.
std::unique_ptr<SimulatedWeather> makeWeather(const SimulatedWeatherParams& params,
                                              const Scenario& scenario, std::uint64_t seed);

}  // namespace perception
