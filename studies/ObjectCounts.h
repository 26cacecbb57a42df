#pragma once
#include <optional>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/Evaluation.h"

namespace perception {

inline constexpr std::size_t kLargestError = 20;  ///< objects, of the distributions

/// A tracked log reduced to what the study compares.
struct CountedRun {
  std::vector<int> all,
      classified;  ///< objects in the sector by scene; classified: as a class that is named
  double mean_cars = 0, mean_persons = 0;  ///< classified ones a scene
  std::optional<Evaluation> evaluation;    ///< where there is a truth
  /// True things of any type that count, by instant with a truth, and those of them with an output
  /// of their own, of whatever class.
  std::vector<int> things, held;
};

/// Errors against a reference run and the truth.
struct CountErrors {
  double all = 0, classified = 0;    ///< rms against the reference
  std::optional<double> truth;       ///< rms of outputs that count against truth objects that do
  std::optional<double> truth_bias;  ///< mean of the same difference
  std::optional<double> unheld;      ///< rms number of true things without an output
  std::vector<double> cdf_all, cdf_classified;  ///< share of scenes with an error of at most i
};

CountedRun countObjects(const TrackedRun& run, const GroundTruth* truth,
                        const EvaluationOptions& options);
CountErrors compareCounts(const CountedRun& run, const CountedRun& reference);

}  // namespace perception
