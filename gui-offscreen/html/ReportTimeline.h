#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gui-offscreen/html/ObjectLives.h"
#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/files/TrackedRunReader.h"

namespace perception {

/// Name of a class of the run; "?" if out of range.
std::string nameOfClass(const RunOutline& run, ClassId c);

/// Place of a time axis in an SVG [px].
struct TimelineSpan {
  double left, width;
};
inline constexpr double kTimelineTop = 24;  ///< [px] rows begin below the figures of the axis

/// Lines of the grid and times from 0 to `end` [s], down to `bottom` [px].
std::string timeAxis(double end, const TimelineSpan& span, double bottom);

/// Stretches of time in which something other than objects was there, as the first row of the
/// timeline.
struct TimelineNote {
  struct Stretch {
    double from = 0, to = 0;  ///< [s]
    std::string title;
  };
  std::string name;
  std::vector<Stretch> stretches;  ///< none: no row
};

/// From the events phantoms_begin and phantoms_end of all lidars (events.jsonl as an array); what
/// does not end lasts until `end` [s].
TimelineNote phantomNote(const nlohmann::json& events, double end);

/// SVG of the page of a run: one row for the note and one per object in the given order, time axis
/// from 0 to `end` [s]; pale where not classified.
std::string timelineChart(const RunOutline& run, const std::vector<ObjectLife>& lives, double end,
                          const TimelineNote& note = {});

}  // namespace perception
