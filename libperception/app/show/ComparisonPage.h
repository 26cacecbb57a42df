#pragma once
#include <string>

#include "libperception/app/show/CompareRuns.h"

namespace perception {

/// A self-contained HTML page of what differs between two runs: inputs, figures, objects over time
/// and one by one.
std::string comparisonPage(const RunComparison& comparison);

}  // namespace perception
