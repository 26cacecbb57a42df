#pragma once
#include <string>
#include <vector>

#include "gui-offscreen/ObjectLives.h"

namespace perception {

/// Name of a class of the run; "?" if out of range.
std::string nameOfClass(const TrackedRun& run, ClassId c);

/// Place of a time axis in an SVG [px].
struct TimelineSpan {
  double left, width;
};
inline constexpr double kTimelineTop = 24;  ///< [px] rows begin below the figures of the axis

/// Lines of the grid and times from 0 to `end` [s], down to `bottom` [px].
std::string timeAxis(double end, const TimelineSpan& span, double bottom);

/// SVG of the page of a run: one row per object in the given order, time axis from 0 to `end` [s];
/// pale where not classified.
std::string timelineChart(const TrackedRun& run, const std::vector<ObjectLife>& lives, double end);

}  // namespace perception
