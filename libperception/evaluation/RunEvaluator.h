#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/RunList.h"
#include "libperception/evaluation/tables/Report.h"

namespace perception {

/// How runs are compared with their truth.
struct RunEvaluatorOptions {
  EvaluationOptions params;
  std::string truth_poses;              ///< run with the poses of the truth's world, or empty
  std::string reference;                ///< reference run of the number of objects, or empty
  std::vector<std::string> front_ends;  ///< labels of sensors, or patterns of them
  bool any_truth = false;               ///< also a truth of another log, or one that no scene has
  bool surroundings = false;            ///< the truth includes poles and hedges
  bool nuscenes = false;                ///< AMOTA and AMOTP of its tracking benchmark
};

/// Compares runs with their truths, which are read once each.
class RunEvaluator {
 public:
  using Listener = std::function<void(const std::string&)>;

  /// `warn` is told of figures that are not available, `note` of what is in no figure. Throws
  /// DataError where truth_poses is no run.
  RunEvaluator(RunEvaluatorOptions options, Listener warn, Listener note);

  const RunEvaluatorOptions& options() const { return options_; }
  /// Throws DataError.
  const GroundTruth& truth(const std::string& path);
  /// The run is not pooled, and has no id yet. Throws DataError.
  EvaluatedRun evaluated(const RunEntry& entry, const std::string& name);

 private:
  void evaluateFrontEnds(const RunEntry& entry, const GroundTruth& truth, EvaluatedRun& run) const;
  void tellOfGaps(const EvaluatedRun& run, const std::string& truth) const;

  RunEvaluatorOptions options_;
  Listener warn_, note_;
  std::map<std::string, GroundTruth> truths_;  ///< read so far, by path
};

}  // namespace perception
