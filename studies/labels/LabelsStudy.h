#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/metrics/Evaluation.h"
#include "libperception/evaluation/metrics/Metrics.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/pipeline/input/RecordedLog.h"
#include "studies/labels/LabelNoise.h"

namespace perception {

/// A log that can be recorded with modified detections.
struct LabeledLog {
  using Edit = std::function<void(ObjectDetections& detections, Stamp stamp)>;
  std::string name;
  GroundTruth truth;
  /// Reads the log with `edit` applied to every frame of detections. Thread-safe.
  std::function<RecordedLog(const Edit& edit)> record;
};

/// Joint classification compared with one tracker per class on corrupted labels.
struct LabelsParams {
  std::vector<double> shares = {0.1, 0.2, 0.3, 0.4, 0.5};  ///< of labels that are corrupted
  std::vector<std::string> labels = {"Car", "Pedestrian", "Cyclist"};  ///< as the detector's
  double group_distance = 0.8;                                         ///< [m] as the front end's
  double least_output = 0.5;  ///< smallest P(exists and is a road user) of an output object
  int last_measurement = 40;  ///< largest number of measurements in the curves
  std::uint64_t seed = 1;
  EvaluationOptions evaluation;  ///< criteria of counted objects
};

/// The objects of a run with P(exists and is a road user) >= `least_output`; their class is the
/// most probable one of `classes`, or `forced` if >= 0.
TrackedRun roadUsers(const TrackedRun& run, const std::vector<bool>& is_road_user,
                     const std::vector<ClassId>& classes, double least_output, ClassId forced = -1);

/// Merges runs of one log, with distinct ids.
TrackedRun joined(const std::vector<TrackedRun>& runs);

/// Score of a tracking method on one log under one corruption.
struct LabelScore {
  ClearFigures any_class;              ///< one-to-one, class ignored
  std::vector<ClearFigures> of_class;  ///< by label: outputs and objects of that class
  /// By label, by number of measurements k = 1, 2 ...: number of objects with a k-th measurement,
  /// and of those with an output of the correct class at that time.
  std::vector<std::vector<std::size_t>> objects, right;
};

/// `numbers`: by sample of the evaluation of all classes: index k = 1, 2 ... of the object's
/// measurement at that instant; 0: none.
LabelScore scoreLabels(const TrackedRun& run, const GroundTruth& truth,
                       const std::vector<int>& numbers, const std::vector<ClassId>& classes,
                       const LabelsParams& params);

StudyReport labelsStudy(const LabelsParams& params, const std::vector<LabeledLog>& logs);

}  // namespace perception
