#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/plots/PlotScript.h"
#include "libperception/evaluation/tables/Report.h"

namespace perception {

/// Draws into DIR/plots: timelines.png (estimated class of every truth object over time, and false
/// objects), overview.png (tracked or not over time; numbers of missed and false objects),
/// set_distance.png (GOSPA and OSPA over time), reliability.png and existence.png (calibration of
/// class and existence probability), object_ID.png (range and bearing of truth and estimate over
/// time, for the `max_objects` truth objects with most active instants). Data and script are kept
/// beside the pictures. One-to-one matching. Throws OutputError.
PlotResult writePlots(const EvaluatedRun& run, const EvaluationOptions& options,
                      const std::string& dir, std::size_t max_objects);

/// Several runs or conditions in one plot each: comparison.png, reliability.png, existence.png and,
/// for single runs, set_distance.png. Throws OutputError.
PlotResult writeComparisonPlots(const EvaluationReport& report, const std::string& dir);

}  // namespace perception
