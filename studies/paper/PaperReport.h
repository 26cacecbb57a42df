#pragma once
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/paper/PaperRuns.h"

namespace perception {

/// The tables of [radecki2016] on simulated encounters, its number beside ours. A row of which
/// nothing was run has no number of ours.
std::vector<StudyTable> paperTables(const std::vector<PaperOutcome>& outcomes);

}  // namespace perception
