#pragma once
#include <optional>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

inline constexpr std::size_t kLargestError = 20;  ///< upper end of the error distributions

/// Object counts of a tracked log.
struct CountedRun {
  std::vector<int> all,
      classified;  ///< objects in the sector by scene; classified: as a named class
  double mean_cars = 0, mean_persons = 0;  ///< classified objects per scene
  std::optional<Evaluation> evaluation;    ///< if there is truth
  /// Counted truth objects of any type by instant with truth, and those matched to an output of any
  /// class.
  std::vector<int> things, held;
};

/// Errors against a reference run and the truth.
struct CountErrors {
  double all = 0, classified = 0;  ///< rms against the reference
  std::optional<double> truth;     ///< rms difference of counted outputs and counted truth objects
  std::optional<double> truth_bias;             ///< mean of that difference
  std::optional<double> unheld;                 ///< rms number of truth objects without an output
  std::vector<double> cdf_all, cdf_classified;  ///< share of scenes with an error of at most i
};

CountedRun countObjects(const TrackedRun& run, const GroundTruth* truth,
                        const EvaluationOptions& options);
CountErrors compareCounts(const CountedRun& run, const CountedRun& reference);

}  // namespace perception
