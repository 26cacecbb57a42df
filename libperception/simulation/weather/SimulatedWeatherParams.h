#pragma once
#include <string>

#include "libperception/config/ParamSet.h"

namespace perception {

/// [weather]: what lies between the sensors and the scene; one cause acts on all sensors. In a
/// scenario, or in an INI of its own (--weather). Default: clear air.
struct SimulatedWeatherParams {
  enum class Sky { kOfScenario, kNight, kCloudy, kSunny };
  double rain_mm_h = 0;        ///< [mm/h] method.md 9.1
  double snow_mm_h = 0;        ///< [mm/h] of water, method.md 9.2
  double fog_mor = 0;          ///< [m] meteorological optical range, method.md 9.3; 0: no fog
  double water_film_mm = 0;    ///< [mm] mean depth on the road, method.md 9.7
  double snow_cover = 0;       ///< [0, 1] share of objects and ground under snow, method.md 9.9
  Sky sky = Sky::kOfScenario;  ///< method.md 9.9
  double fouling = 0;          ///< [0, 1] share of the windows of lidars and cameras under dirt
  double radome_db = 0;        ///< [dB] one way, of water or snow on radars, method.md 9.8

  void visit(ParamVisitor& v);
  /// Water on objects: of rain, or where the road is wet.
  bool wet() const { return rain_mm_h > 0 || water_film_mm > 0; }
  /// As the log's first comment says it: "rain 10 mm/h, fog 150 m"; empty in clear air.
  std::string text() const;
};

}  // namespace perception
