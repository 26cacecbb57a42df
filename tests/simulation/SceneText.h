#pragma once
#include <string>

#include "libperception/config/Config.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception::test {

/// A scene of one second with a vehicle at rest at the origin, looking along x, on a smooth road.
inline const std::string kStanding = R"(
[scenario]
duration = 1
ground_roughness = 0
[ego]
t = 0
x = 0
y = 0
)";

inline const std::string kRoofLidar = R"(
[sensor.LIDAR_TOP]
kind = lidar64
)";

inline const std::string kCamera = R"(
[sensor.CAMERA]
kind = camera_boxes
z = 1.65
)";

/// [object.NAME] that never moves.
inline std::string parked(const std::string& name, const std::string& kind, double x, double y,
                          const std::string& more = "") {
  return "[object." + name + "]\nkind = " + kind + "\nt = 0\nx = " + std::to_string(x) +
         "\ny = " + std::to_string(y) + "\n" + more + "\n";
}

/// Throws ConfigError with all faults.
inline Scenario scenarioOf(const std::string& text) {
  Config config = Config::fromText(text);
  Scenario scenario = readScenario(config);
  config.finish();
  return scenario;
}

}  // namespace perception::test
