#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/evaluation/without_truth/Quality.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// A run whose quality is judged without a truth.
struct JudgedRun {
  std::string name, condition;
  RunRecord record;
  TrackedRun run;
  std::optional<std::array<Figure, kTrueErrors>> errors;  ///< where it has a truth
  Quality quality;                                        ///< from qualityReport()
};

/// Figures of runs that need no truth, and with one how they follow the true errors. Throws
/// DataError.
StudyReport qualityReport(std::vector<JudgedRun>& judged, const QualityOptions& options,
                          bool has_truth);

}  // namespace perception
