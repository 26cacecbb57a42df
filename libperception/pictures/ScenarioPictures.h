#pragma once
#include <string>
#include <vector>

#include "gui-offscreen/drawing/Picture.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {

/// Coverage of each sensor of a vehicle, one panel per modality with its own scale, the vehicle in
/// the center facing right (as in the figure of [radecki2016]); names, ranges and rates below.
Picture coveragePicture(const std::vector<SensorParams>& sensors, const std::string& title);

/// A scenario and its name.
struct NamedScenario {
  std::string name;
  Scenario scenario;
};
/// Top views side by side: roads, static objects, paths of moving objects with their positions at
/// the start, half-way (filled) and at the end (arrow). World x to the right, y up.
Picture scenarioSheet(const std::vector<NamedScenario>& scenarios);

}  // namespace perception
