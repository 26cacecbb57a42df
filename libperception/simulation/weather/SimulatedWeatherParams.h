#pragma once
#include <string>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"

namespace perception {

/// [weather]: what lies between the sensors and the scene; one cause acts on all sensors. In a
/// scenario, or in an INI of its own (--weather). Default: clear air.
struct SimulatedWeatherParams {
  enum class Sky { kOfScenario, kNight, kCloudy, kSunny };
  /// Where lidar returns of rain and snow come from (method.md 9.1, 9.2): the law measured with a
  /// VLP-16; flakes by their sizes and the lidar's own detection limit (rain as measured); or
  /// single drops and flakes, the second generator for validation.
  enum class Precipitation { kMeasured, kSizes, kParticles };
  Precipitation precipitation = Precipitation::kMeasured;
  double beam_divergence_mrad = 3;  ///< [mrad] of the second generator's lidars, method.md 9
  double flake_reflectivity = 0.9;  ///< [0, 1] of its flakes [hahner2022], method.md 9.2
  double rain_mm_h = 0;             ///< [mm/h] method.md 9.1
  double snow_mm_h = 0;             ///< [mm/h] of water, method.md 9.2
  double fog_mor = 0;               ///< [m] meteorological optical range, method.md 9.3; 0: no fog
  double water_film_mm = 0;         ///< [mm] mean depth on the road, method.md 9.7
  double snow_cover = 0;        ///< [0, 1] share of objects and ground under snow, method.md 9.9
  Sky sky = Sky::kOfScenario;   ///< method.md 9.9
  double shop_windows = 0;      ///< [0, 1] share of glass in the ground floors of houses
  double fouling = 0;           ///< [0, 1] share of the windows of lidars and cameras under dirt
  double radome_db = 0;         ///< [dB] one way, of water or snow on radars, method.md 9.8
  double air_temperature = 20;  ///< [deg C] below 8 exhaust is seen, method.md 9.5; assumed
  double humidity = 0.5;        ///< [0, 1] relative; above 0.85 exhaust is seen; assumed
  double wind_speed = 0;        ///< [m/s] carries spray and exhaust
  double wind_towards = 0;      ///< [rad] world, from x towards y

  void visit(ParamVisitor& v);
  /// Water on objects: of rain, or where the road is wet.
  bool wet() const { return rain_mm_h > 0 || water_film_mm > 0; }
  /// Exhaust condenses.
  bool plumes() const { return air_temperature < 8 || humidity > 0.85; }
  Vector2 wind() const;  ///< [m/s] world
  /// As the log's first comment says it: "rain 10 mm/h, fog 150 m"; empty in clear air.
  std::string text() const;
};

}  // namespace perception
