#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libperception/calibration/detectors/BoxEvidenceStudy.h"
#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

/// What the study of a detector's confidence needs.
struct ConfidenceInput {
  std::string sensor;
  std::map<std::string, std::string> names;  ///< the detector's class = label of the INI
  double clutter_per_scan = 1;               ///< of the INI: the scores' ratios are made for it
  std::vector<BoxLog> logs;
  std::vector<GroundTruth> truths;  ///< of the logs
  EvaluationOptions evaluation;
  /// Tracks a log with these keys of [sensor.LABEL.positions]; outputs all objects from
  /// leastExistence() on. May be called from several threads.
  std::function<TrackedRun(std::size_t log, const ScoreKeys& keys)> track;
};

/// Lowest threshold of the search.
double leastExistence();

/// `confidence = fitted`: the odds of scores by label, fitted to the truth, and the output
/// threshold [scene] min_existence of the highest MOTA (pooled over the logs). Each log is tracked
/// with the odds that the others taught, so the threshold is one for detections that were not
/// fitted to; its own figures are at the threshold that the others chose. Writes confidence.ini.
/// Throws DataError when no box can be judged.
StudyReport confidenceStudy(const ConfidenceInput& input, const std::string& include);

}  // namespace perception
