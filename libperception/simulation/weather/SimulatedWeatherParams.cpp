#include "libperception/simulation/weather/SimulatedWeatherParams.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace perception {
namespace {

const std::vector<std::string> kSkies = {"as_scenario", "night", "cloudy", "sunny"};
const std::vector<std::string> kPrecipitations = {"measured", "sizes", "particles"};

}  // namespace

void SimulatedWeatherParams::visit(ParamVisitor& v) {
  v.choiceOf("precipitation", precipitation, kPrecipitations,
             "lidar returns of rain and snow: by a measured law, of flakes by their sizes, or drop "
             "by drop");
  v.real("rain_mm_h", rain_mm_h, {0, 200}, "mm/h", "rain; 50 is a downpour");
  v.real("snow_mm_h", snow_mm_h, {0, 20}, "mm/h", "snowfall, as water; from 2.5 on it is heavy");
  v.real("fog_mor", fog_mor, {0, 20000}, "m", "range of sight in fog; 0: none");
  v.real("water_film_mm", water_film_mm, {0, 10}, "mm", "on the road; from 1.2 on it is a mirror");
  v.real("snow_cover", snow_cover, {0, 1}, "-", "share of objects and ground that snow covers");
  v.choiceOf("sky", sky, kSkies, "as_scenario: its own [light]");
  v.real("shop_windows", shop_windows, {0, 1}, "-",
         "share of glass in the ground floors of houses; mirrors in any weather");
  v.real("fouling", fouling, {0, 1}, "-", "share of the windows of lidars and cameras under dirt");
  v.real("radome_db", radome_db, {0, 60}, "dB", "one way: 1.5 to 3 wet, 30 under packed snow");
  v.real("air_temperature", air_temperature, {-60, 60}, "deg C", "below 8 one sees exhaust");
  v.real("humidity", humidity, {0, 1}, "-", "relative; above 0.85 one sees exhaust");
  v.real("wind_speed", wind_speed, {0, 50}, "m/s", "carries spray and exhaust");
  v.angle("wind_towards_deg", wind_towards, {-360, 360}, "where it blows: world, from x towards y");
  v.expert();
  v.real("beam_divergence_mrad", beam_divergence_mrad, {0.1, 20}, "mrad",
         "full angle of a lidar's beam, for drops and flakes one by one");
  v.real("flake_reflectivity", flake_reflectivity, {0.01, 1}, "-",
         "of a snow flake at the lidar's wavelength, for flakes one by one");
  v.require(fog_mor == 0 || fog_mor >= 10, "fog_mor: expected 0 or 10 m and more");
}

Vector2 SimulatedWeatherParams::wind() const {
  return wind_speed * Vector2(std::cos(wind_towards), std::sin(wind_towards));
}

std::string SimulatedWeatherParams::text() const {
  std::vector<std::string> parts;
  const auto add = [&](const char* format, double value) {
    if (value > 0) parts.push_back(fmt::format(fmt::runtime(format), value));
  };
  add("rain {:g} mm/h", rain_mm_h);
  add("snow {:g} mm/h", snow_mm_h);
  if (precipitation == Precipitation::kParticles && (rain_mm_h > 0 || snow_mm_h > 0))
    parts.emplace_back("particle by particle");
  if (precipitation == Precipitation::kSizes && snow_mm_h > 0)
    parts.emplace_back("flakes by their sizes");
  add("fog {:g} m", fog_mor);
  add("water film {:g} mm", water_film_mm);
  add("snow cover {:g}", snow_cover);
  if (sky != Sky::kOfScenario) parts.push_back(kSkies[static_cast<std::size_t>(sky)]);
  add("shop windows {:g}", shop_windows);
  add("fouling {:g}", fouling);
  add("radomes {:g} dB", radome_db);
  if (plumes()) parts.push_back(fmt::format("exhaust seen at {:g} deg C", air_temperature));
  add("wind {:g} m/s", wind_speed);
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace perception
