#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"

namespace CLI {
class App;
}

namespace perception {

/// perception-study weather.
struct WeatherOptions {
  std::vector<std::string> logs;     ///< CONFIG=LOG=TYPE: as they are
  std::vector<std::string> through;  ///< CONFIG=LOG: clear ones on which weather is put
};
void declareWeather(CLI::App& cli, WeatherOptions& options);

/// The estimated weather of recordings beside what it was, and of clear ones and scenarios through
/// rain and snow of both generators (method.md 9.1, 9.2) at many rates.
StudyReport weatherStudy(const WeatherOptions& options, std::uint64_t seed);

}  // namespace perception
