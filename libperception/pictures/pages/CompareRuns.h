#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gui-offscreen/html/RunParts.h"
#include "libperception/evaluation/without_truth/RunDifference.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// What a run's folder says of the run beside its scenes.
struct ComparedRun {
  std::string dir;  ///< as given
  RunRecord record;
  TrackedRun tracked;
  nlohmann::json evaluation;  ///< of this run in evaluation/report.json, or null
};

/// A key of effective.ini with different values; "" where a run has no such key.
struct KeyDifference {
  std::string key;  ///< section.key
  std::string a, b;
};

/// Two runs of the same log and what differs.
struct RunComparison {
  ComparedRun a, b;
  std::vector<KeyDifference> keys;       ///< those of A in the order of its file, then others of B
  std::vector<std::string> without_ini;  ///< folders without effective.ini: keys are not compared
  RunDifference difference;
  std::vector<std::string> without_origin;  ///< evaluations that do not say of which run they are
  std::string film;                         ///< path of an MP4 of both, or empty
  std::vector<std::unique_ptr<RunParts>> parts;  ///< "a" and "b"; none: without the view of both
};

/// Reads the folders of two runs. Throws DataError where a file is missing or wrong, and for runs
/// of different logs (another file name, or no time in common), naming both.
RunComparison readComparison(const std::string& dir_a, const std::string& dir_b);

}  // namespace perception
