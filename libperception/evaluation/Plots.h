#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/Report.h"

namespace perception {

/// What came of the plots.
struct PlotResult {
  std::vector<std::string> files;  ///< PNG names relative to the folder, "plots/overview.png" ...
  std::string fault;               ///< why there are fewer than there should be; for a warning
};

/// Draws into DIR/plots: overview.png (every truth object over time; misses and false objects),
/// reliability.png (can the class probability be believed), object_ID.png (range and bearing of
/// truth and estimate over time; for the `max_objects` truth objects that count longest). Data and
/// script stay beside the pictures. One-to-one matching. Throws OutputError.
PlotResult writePlots(const EvaluatedRun& run, const EvaluationOptions& options,
                      const std::string& dir, std::size_t max_objects);

}  // namespace perception
