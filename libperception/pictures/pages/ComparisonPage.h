#pragma once
#include "libperception/core/system/SpoolFile.h"
#include "libperception/pictures/pages/CompareRuns.h"

namespace perception {

/// Writes a self-contained HTML page of what differs between two runs: inputs, figures, objects
/// over time and one by one.
void writeComparisonPage(const RunComparison& comparison, const TextSink& sink);

}  // namespace perception
