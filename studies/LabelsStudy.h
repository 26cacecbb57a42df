#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/Evaluation.h"
#include "libperception/evaluation/Metrics.h"
#include "libperception/evaluation/StudyReport.h"
#include "libperception/pipeline/RecordedLog.h"
#include "studies/LabelNoise.h"

namespace perception {

/// A log whose front ends can be run on corrupted detections.
struct LabeledLog {
  using Edit = std::function<void(ObjectDetections& detections, Stamp stamp)>;
  std::string name;
  GroundTruth truth;
  /// Reads the log with every frame of detections changed by `edit`. Called by several threads.
  std::function<RecordedLog(const Edit& edit)> record;
};

/// What labels are worth: joint classification beside a tracker per class, on corrupted labels.
struct LabelsParams {
  std::vector<double> shares = {0.1, 0.2, 0.3, 0.4, 0.5};  ///< of labels that are corrupted
  std::vector<std::string> labels = {"Car", "Pedestrian", "Cyclist"};  ///< as the detector's
  double group_distance = 0.8;                                         ///< [m] as the front end's
  double least_output = 0.5;  ///< P(it exists and is a road user) from which an object is output
  int last_measurement = 40;  ///< of an object, in the curves
  std::uint64_t seed = 1;
  EvaluationOptions evaluation;  ///< where objects count
};

/// A run's objects reduced to what is output: P(exists, road user) of at least `least_output`,
/// their class the likeliest of `classes`, or `forced` where that is not negative.
TrackedRun roadUsers(const TrackedRun& run, const std::vector<bool>& is_road_user,
                     const std::vector<ClassId>& classes, double least_output, ClassId forced = -1);

/// Several runs of one log as one, ids kept apart.
TrackedRun joined(const std::vector<TrackedRun>& runs);

/// How one way to track one log fared under one damage.
struct LabelScore {
  ClearFigures any_class;              ///< one output to one object, whatever its class
  std::vector<ClearFigures> of_class;  ///< by label: outputs of that class against its objects
  /// By label, by number of measurements k = 1, 2 ...: objects that had a k-th, and those of them
  /// that then had an output of the right class.
  std::vector<std::vector<std::size_t>> objects, right;
};

/// `numbers`: by sample of the evaluation of all classes, the how-manieth measurement of its
/// object it is, 0: none. `truth` holds what counts.
LabelScore scoreLabels(const TrackedRun& run, const GroundTruth& truth,
                       const std::vector<int>& numbers, const std::vector<ClassId>& classes,
                       const LabelsParams& params);

StudyReport labelsStudy(const LabelsParams& params, const std::vector<LabeledLog>& logs);

}  // namespace perception
