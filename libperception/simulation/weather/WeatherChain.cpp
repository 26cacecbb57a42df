#include "libperception/simulation/weather/WeatherChain.h"

#include <utility>

#include "libperception/simulation/weather/particles/Fog.h"
#include "libperception/simulation/weather/particles/Plume.h"
#include "libperception/simulation/weather/particles/Rain.h"
#include "libperception/simulation/weather/particles/RainDrops.h"
#include "libperception/simulation/weather/particles/Snow.h"
#include "libperception/simulation/weather/particles/SnowFlakes.h"
#include "libperception/simulation/weather/particles/Spray.h"
#include "libperception/simulation/weather/sensors/Daylight.h"
#include "libperception/simulation/weather/sensors/Fouling.h"
#include "libperception/simulation/weather/surfaces/ShopWindows.h"
#include "libperception/simulation/weather/surfaces/TargetSurfaces.h"
#include "libperception/simulation/weather/surfaces/WetGround.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

template <class What>
void pass(const std::vector<std::unique_ptr<SimulatedWeather>>& phenomena,
          const SensorParams& sensor, What& what, Rng& rng) {
  for (const auto& phenomenon : phenomena) phenomenon->alter(sensor, what, rng);
}

void addPrecipitation(const SimulatedWeatherParams& p, std::uint64_t seed,
                      std::vector<std::unique_ptr<SimulatedWeather>>& phenomena) {
  using Precipitation = SimulatedWeatherParams::Precipitation;
  const bool particles = p.precipitation == Precipitation::kParticles,
             by_sizes = p.precipitation == Precipitation::kSizes;
  const ParticleReceiver receiver = {1e-3 * p.beam_divergence_mrad, p.flake_reflectivity};
  if (p.rain_mm_h > 0 && particles)
    phenomena.push_back(std::make_unique<RainDrops>(p.rain_mm_h, seed, receiver));
  else if (p.rain_mm_h > 0)
    phenomena.push_back(std::make_unique<Rain>(p.rain_mm_h, seed));
  if (p.snow_mm_h > 0 && particles)
    phenomena.push_back(std::make_unique<SnowFlakes>(p.snow_mm_h, seed, receiver));
  else if (p.snow_mm_h > 0)
    phenomena.push_back(std::make_unique<Snow>(p.snow_mm_h, seed, by_sizes));
}

}  // namespace

WeatherChain::WeatherChain(std::vector<std::unique_ptr<SimulatedWeather>> phenomena)
    : phenomena_(std::move(phenomena)) {
  for (const auto& phenomenon : phenomena_) {
    if (phenomenon->actsOnPulses()) on_pulses_.push_back(phenomenon.get());
  }
}

void WeatherChain::advance(const World& world, const SensorParams& sensor, double t) {
  for (const auto& phenomenon : phenomena_) phenomenon->advance(world, sensor, t);
}

void WeatherChain::alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const {
  for (const SimulatedWeather* phenomenon : on_pulses_) phenomenon->alter(sensor, pulse, rng);
}

void WeatherChain::alter(const SensorParams& sensor, RadarReflection& r, Rng& rng) const {
  pass(phenomena_, sensor, r, rng);
}

void WeatherChain::alter(const SensorParams& sensor, RadarAir& air, Rng& rng) const {
  pass(phenomena_, sensor, air, rng);
}

void WeatherChain::alter(const SensorParams& sensor, CameraLook& look, Rng& rng) const {
  pass(phenomena_, sensor, look, rng);
}

void WeatherChain::alter(const SensorParams& sensor, Lighting& light, Rng& rng) const {
  pass(phenomena_, sensor, light, rng);
}

void WeatherChain::alter(const SensorParams& sensor, CameraView& view, Rng& rng) const {
  pass(phenomena_, sensor, view, rng);
}

void WeatherChain::alter(const SensorParams& sensor, SensorFrame& frame, Rng& rng) const {
  pass(phenomena_, sensor, frame, rng);
}

// Surfaces first, then the air; ghosts of mirrors need the air's extinction.
std::unique_ptr<SimulatedWeather> makeWeather(const SimulatedWeatherParams& p,
                                              const Scenario& scenario, std::uint64_t seed) {
  using Sky = SimulatedWeatherParams::Sky;
  std::vector<std::unique_ptr<SimulatedWeather>> phenomena;
  const auto add = [&](auto phenomenon) { phenomena.push_back(std::move(phenomenon)); };
  if (p.fouling > 0 || p.radome_db > 0)
    add(std::make_unique<Fouling>(p.fouling, p.radome_db, seed));
  if (p.wet() || p.snow_cover > 0) add(std::make_unique<TargetSurfaces>(p.wet(), p.snow_cover));
  addPrecipitation(p, seed, phenomena);
  if (p.fog_mor > 0) add(std::make_unique<Fog>(p.fog_mor));
  if (p.shop_windows > 0) add(std::make_unique<ShopWindows>(p.shop_windows, seed));
  if (p.water_film_mm > 0)
    add(std::make_unique<WetGround>(p.water_film_mm * (1 - p.snow_cover),
                                    objectFactor(p.wet(), p.snow_cover)));
  if (p.water_film_mm > 0 || p.snow_cover > 0)
    add(std::make_unique<Spray>(p.water_film_mm, p.snow_cover, p.wind(), seed));
  if (p.plumes()) add(std::make_unique<Plume>(p.wind(), seed));
  if (p.sky != Sky::kOfScenario) add(std::make_unique<Daylight>(p.sky, scenario.light));
  if (phenomena.empty()) return nullptr;
  return std::make_unique<WeatherChain>(std::move(phenomena));
}

}  // namespace perception
