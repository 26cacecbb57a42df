#pragma once
#include <optional>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/metrics/Evaluation.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/pipeline/input/RecordedLog.h"
#include "studies/association/ObjectCounts.h"

namespace perception {

/// The second particle study of [radecki2016] on a log: errors of the number of objects over the
/// number of particles, with the tracker of the DARPA Urban Challenge and with joint
/// classification.
struct LogParticlesParams {
  std::vector<int> counts = {1, 4, 8, 12, 16, 20};  ///< [radecki2016]
  int reference = 50;                               ///< [radecki2016]
  std::uint64_t seed = 1;
  EvaluationOptions evaluation;  ///< sector in which objects count
};

/// `duc`: the same log recorded with DUC's configuration; may be null.
StudyReport logParticlesStudy(const LogParticlesParams& params, const RecordedLog& joint,
                              const RecordedLog* duc, const GroundTruth* truth);

}  // namespace perception
