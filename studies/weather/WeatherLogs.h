#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "libperception/pipeline/phantoms/WeatherWatch.h"
#include "libperception/simulation/weather/SimulatedWeatherParams.h"

namespace perception {

/// Something to judge the weather by: CONFIG=LOG=TYPE, as on the command line.
struct WeatherLog {
  std::string config;  ///< INI of the vehicle
  std::string log;     ///< rawlog, or a scenario INI
  WeatherType type = WeatherType::kClear;

  /// Throws Error (kUsage) for anything else; the type may be missing: clear.
  static WeatherLog parse(const std::string& text);
  std::string name() const;  ///< of the file, without extension
  bool isScenario() const;
};

/// Weather of this type and rate [mm/h], as ini/weather has it, by one of the two generators.
SimulatedWeatherParams precipitationOf(WeatherType type, double mm_h,
                                       SimulatedWeatherParams::Precipitation generator);

/// The weather by each scan of a log, as it is or through simulated weather; of its first `until`
/// [s] alone. Throws DataError where no lidar's returns are weighed.
std::vector<WeatherRow> weatherOf(const WeatherLog& log, const SimulatedWeatherParams* weather,
                                  std::uint64_t seed,
                                  double until = std::numeric_limits<double>::infinity());

}  // namespace perception
