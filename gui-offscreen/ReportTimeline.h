#pragma once
#include <string>
#include <vector>

#include "gui-offscreen/ObjectLives.h"

namespace perception {

/// Name of a class of the run; "?" if out of range.
std::string nameOfClass(const TrackedRun& run, ClassId c);

/// SVG of the page of a run: one row per object in the given order, time axis from 0 to `end` [s];
/// pale where not classified.
std::string timelineChart(const TrackedRun& run, const std::vector<ObjectLife>& lives, double end);

}  // namespace perception
