#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/PlotScript.h"
#include "libperception/evaluation/Report.h"

namespace perception {

/// Draws into DIR/plots: timelines.png (what every truth object was called, and false objects),
/// overview.png (tracked or not over time; numbers of misses and false objects), set_distance.png
/// (GOSPA and OSPA over time), reliability.png and existence.png (can the probabilities be
/// believed), object_ID.png (range and bearing of truth and estimate over time; for the
/// `max_objects` truth objects that count longest). Data and script stay beside the pictures.
/// One-to-one matching. Throws OutputError.
PlotResult writePlots(const EvaluatedRun& run, const EvaluationOptions& options,
                      const std::string& dir, std::size_t max_objects);

/// Several runs or conditions in the same pictures: comparison.png, reliability.png, existence.png
/// and, of single runs, set_distance.png. Throws OutputError.
PlotResult writeComparisonPlots(const EvaluationReport& report, const std::string& dir);

}  // namespace perception
