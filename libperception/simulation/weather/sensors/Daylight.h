#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/SimulatedWeatherParams.h"

namespace perception {

/// Night, clouds or sun (method.md 9.9). Lidar: threshold and noise returns of background light.
/// Camera: what the night hides, glare of a low sun and of headlights; light and noise of images.
class Daylight final : public SimulatedWeather {
 public:
  using Sky = SimulatedWeatherParams::Sky;
  Daylight(Sky sky, const Lighting& light);  ///< light: where the sun stands

  using SimulatedWeather::alter;
  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  void alter(const SensorParams&, Lighting& light, Rng&) const override;
  void alter(const SensorParams&, CameraView& view, Rng& rng) const override;
  bool actsOnPulses() const override { return sky_ == Sky::kSunny || sky_ == Sky::kCloudy; }

 private:
  /// A direction into which a camera looks badly.
  struct Glare {
    double azimuth;      // [rad] world
    std::size_t source;  // the object that shines, if it is one
  };

  Sky sky_;
  bool low_sun_;
  double sun_azimuth_;        // [rad] world
  double heading_ = 0;        // [rad] of the vehicle, world, at the last advance()
  std::vector<Glare> glare_;  // for the sensor of the last advance()
};

}  // namespace perception
