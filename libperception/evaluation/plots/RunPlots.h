#pragma once
#include <vector>

#include "libperception/evaluation/plots/PlotScript.h"
#include "libperception/evaluation/tables/Report.h"

namespace perception {

/// timelines.png: one row per truth object, colored by the estimated class (pale where not
/// classified), a thin line where it was missed, a mark at an id switch; below, the false objects.
void drawTimelines(const EvaluatedRun& run, const EvaluationOptions& options, PlotScript& script);

/// set_distance.png: GOSPA over time, one curve per run; for a single run also OSPA and the parts
/// of GOSPA.
void drawSetDistance(const std::vector<const EvaluatedRun*>& runs, const EvaluationOptions& options,
                     PlotScript& script);

/// reliability.png (class) or existence.png: observed frequency over stated probability, one curve
/// per run.
void drawReliability(const std::vector<const EvaluatedRun*>& runs, bool existence,
                     PlotScript& script);

/// comparison.png: the metrics of [radecki2016] for every run or condition as bars with the range
/// over trials, and the published values where it has that condition.
void drawComparison(const EvaluationReport& report, PlotScript& script);

}  // namespace perception
