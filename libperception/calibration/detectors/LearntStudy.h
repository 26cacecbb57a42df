#pragma once
#include <string>
#include <vector>

#include "libperception/calibration/detectors/BoxEvidenceStudy.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Logs of one detector; every log was learned from nothing.
struct LearntGroup {
  std::string name;
  std::vector<BoxLog> logs;  ///< with BoxWithTruth::stated
};

/// `confidence = learnt` against the truth, per group: stated probability against the share of
/// objects (reliability curve) and expected calibration error in tenths (Guo et al., On Calibration
/// of Modern Neural Networks, ICML 2017), settled (from frame 200 of a log on) and by frame since
/// the log's begin. Throws DataError when no box can be judged.
StudyReport learntStudy(const std::vector<LearntGroup>& groups);

}  // namespace perception
