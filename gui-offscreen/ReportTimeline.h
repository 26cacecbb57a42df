#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gui-offscreen/ObjectLives.h"

namespace perception {

/// Name of a class of the run; "?" if out of range.
std::string nameOfClass(const TrackedRun& run, ClassId c);

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

/// SVG of the page of a run: one row for the note and one per
/// object in the given order, time axis from 0 to `end` [s];
/// pale where not classified.
std::string timelineChart(const TrackedRun& run, const std::vector<ObjectLife>& lives, double end,
                          const TimelineNote& note = {});

}  // namespace perception
