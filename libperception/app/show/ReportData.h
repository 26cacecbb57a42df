#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "gui-offscreen/html/RunData.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// What the interactive page of a run shows beside the run; all may be empty.
struct ReportSources {
  std::unique_ptr<SnapshotSensors> sensors;  ///< of the log
  std::optional<GroundTruth> truth;
  nlohmann::json events;          ///< events.jsonl as an array, or null
  std::optional<Vector3> origin;  ///< [m] of the page's places; empty: the run's own
};

/// Errors of a run's objects against the truth, by the one-to-one matching of perception-evaluate
/// with its default options.
RunErrors errorsOf(const TrackedRun& run, const GroundTruth& truth);

/// Data of the run as elements of its page, named PREFIX-...
std::string reportData(const TrackedRun& run, const RunRecord& record, ReportSources& sources,
                       const std::string& prefix);

}  // namespace perception
