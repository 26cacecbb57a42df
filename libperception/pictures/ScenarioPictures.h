#pragma once
#include <string>
#include <vector>

#include "gui-offscreen/Picture.h"
#include "libperception/simulation/Scenario.h"

namespace perception {

/// What each sensor of a vehicle covers, one panel a modality with its own scale, the vehicle in
/// the middle driving to the right (as the figure of [radecki2016]); names, ranges and rates below.
Picture coveragePicture(const std::vector<SensorParams>& sensors, const std::string& title);

/// A scenario as a reader of the INI would draw it.
struct NamedScenario {
  std::string name;
  Scenario scenario;
};
/// Top views side by side: roads, what stands, ways of what moves with where it is at the start,
/// half-way (filled) and at the end (arrow). World x to the right, y up.
Picture scenarioSheet(const std::vector<NamedScenario>& scenarios);

}  // namespace perception
