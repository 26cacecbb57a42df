#pragma once
#include <string>

#include "libperception/config/ParamSet.h"

namespace perception {

/// [weather]: what lies between the sensors and the scene; one cause acts on all sensors. In a
/// scenario, or in an INI of its own (--weather). Default: clear air.
struct SimulatedWeatherParams {
  double rain_mm_h = 0;  ///< [mm/h] method.md 9.1
  double snow_mm_h = 0;  ///< [mm/h] of water, method.md 9.2
  double fog_mor = 0;    ///< [m] meteorological optical range, method.md 9.3; 0: no fog

  void visit(ParamVisitor& v);
  /// As the log's first comment says it: "rain 10 mm/h, fog 150 m"; empty in clear air.
  std::string text() const;
};

}  // namespace perception
