#include "libperception/simulation/weather/SimulatedWeatherParams.h"

#include <fmt/format.h>

#include <vector>

namespace perception {

void SimulatedWeatherParams::visit(ParamVisitor& v) {
  v.real("rain_mm_h", rain_mm_h, {0, 200}, "mm/h", "rain; 50 is a downpour");
  v.real("snow_mm_h", snow_mm_h, {0, 20}, "mm/h", "snowfall, as water; from 2.5 on it is heavy");
  v.real("fog_mor", fog_mor, {0, 20000}, "m", "range of sight in fog; 0: none");
  v.require(fog_mor == 0 || fog_mor >= 10, "fog_mor: expected 0 or 10 m and more");
}

std::string SimulatedWeatherParams::text() const {
  std::vector<std::string> parts;
  const auto add = [&](const char* format, double value) {
    if (value > 0) parts.push_back(fmt::format(fmt::runtime(format), value));
  };
  add("rain {:g} mm/h", rain_mm_h);
  add("snow {:g} mm/h", snow_mm_h);
  add("fog {:g} m", fog_mor);
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace perception
