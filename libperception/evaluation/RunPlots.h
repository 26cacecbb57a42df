#pragma once
#include <vector>

#include "libperception/evaluation/PlotScript.h"
#include "libperception/evaluation/Report.h"

namespace perception {

/// timelines.png: a row a truth object, colored by the class that it was called (pale where not
/// yet sure), a line where it was missed, a mark where its identity changed; below, the false
/// objects.
void drawTimelines(const EvaluatedRun& run, const EvaluationOptions& options, PlotScript& script);

/// set_distance.png: GOSPA over time, one curve a run; of a single run OSPA and GOSPA's parts, too.
void drawSetDistance(const std::vector<const EvaluatedRun*>& runs, const EvaluationOptions& options,
                     PlotScript& script);

/// reliability.png (class) or existence.png: how often what was said was so, one curve a run.
void drawReliability(const std::vector<const EvaluatedRun*>& runs, bool existence,
                     PlotScript& script);

/// comparison.png: the figures of [radecki2016] of every run or condition as bars, range over the
/// trials and its values where it has that condition.
void drawComparison(const EvaluationReport& report, PlotScript& script);

}  // namespace perception
