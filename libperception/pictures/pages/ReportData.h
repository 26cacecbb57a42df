#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/html/ObjectLives.h"
#include "gui-offscreen/html/ReportPage.h"
#include "gui-offscreen/html/RunData.h"
#include "gui-offscreen/html/RunParts.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/core/TruthStream.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/scene/files/TrackedRunReader.h"

namespace perception {

/// What the interactive page of a run shows beside the run; all may be empty.
struct ReportSources {
  /// Scenes around those that are collected, for the sensors; does not move.
  std::unique_ptr<TrackedRun> window = std::make_unique<TrackedRun>();
  std::unique_ptr<SnapshotSensors> sensors;  ///< of the log, over the window
  std::optional<TruthStream> truth;
  std::string events;             ///< path of events.jsonl, or empty
  std::optional<Vector3> origin;  ///< [m] of the page's places; empty: the run's own
};

/// Errors of objects in some scenes of a run against the truth, by the one-to-one matching of
/// perception-evaluate with its default options.
RunErrors errorsOf(const TrackedRun& run, const GroundTruth& truth);

/// A run as its page shows it.
struct CollectedRun {
  std::unique_ptr<RunParts> parts;                    ///< elements named PREFIX-...
  std::vector<ObjectLife> lives;                      ///< of all objects, by id
  nlohmann::json phantoms = nlohmann::json::array();  ///< events of phantoms
};

/// Reads the run from its folder, in step with log and truth; only a part of it is held at a time.
/// `output`: the page, beside which finished parts wait.
CollectedRun collectRun(const RunOutline& run, const RunRecord& record, ReportSources& sources,
                        const std::string& prefix, const std::string& output);

/// What the folder of a run holds for its page: record, pictures, film and evaluation, the last
/// from `evaluation_dir` where that is not empty. `without_origin` is told of files that do not say
/// of which run they are; they are left out. Throws DataError, also where one is of another run.
ReportContent contentOf(const std::string& run_dir, const std::string& evaluation_dir,
                        const std::function<void(const std::string&)>& without_origin);

}  // namespace perception
