#pragma once
#include <cstddef>
#include <vector>

#include "libperception/evaluation/matching/SeenObjects.h"
#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

/// Which outputs are real: those that pair one to one with a truth object within
/// EvaluationOptions::tolerance. Not real are those with no truth object within
/// EvaluationOptions::exclusion, or only ones that pair with another output. An unpaired output
/// near an unpaired truth object may be either, and gives no sample.
///
/// `named`: outputs of named classes in the sector. `truth`: of any type. `instant`: place in
/// Evaluation::instants.
std::vector<ExistenceSample> existenceSamples(const std::vector<SeenEstimate>& named,
                                              const std::vector<SeenTruth>& truth,
                                              const EvaluationOptions& options,
                                              std::size_t instant);

}  // namespace perception
