#pragma once
#include <string>
#include <vector>

#include "gui-offscreen/ObjectLives.h"

namespace perception {

/// The name of a class of the run; "?": it has none.
std::string nameOfClass(const TrackedRun& run, ClassId c);

/// SVG of the page of a run: a row an object in the order given, time to the right from 0 to `end`
/// [s]; pale where its class was not sure.
std::string timelineChart(const TrackedRun& run, const std::vector<ObjectLife>& lives, double end);

}  // namespace perception
