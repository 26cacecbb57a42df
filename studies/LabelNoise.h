#pragma once
#include <string>
#include <vector>

#include "libperception/core/Random.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// The label of a box whose detector does not say what it is. A configuration that takes such boxes
/// lists it among its labels.
inline constexpr const char* kNoLabel = "unknown";

/// How a detector's labels are corrupted: of every thing, with this probability.
struct LabelNoise {
  enum Kind { kNone, kDropped, kFlipped } kind = kNone;
  double probability = 0;  ///< 1 with kDropped: the classes are pooled without labels
};

/// Boxes of different labels nearer to each other than `group_distance` [m] are of one thing. A
/// thing that is hit keeps its surest box alone, with place, size and score; its label becomes
/// kNoLabel (dropped) or one of the others, each alike (flipped). What is hit with one probability
/// is also hit with a larger one.
void corruptLabels(const LabelNoise& damage, const std::vector<std::string>& labels,
                   double group_distance, const RngKey& key, ObjectDetections& detections);

/// Keeps one label's boxes and, if asked for, those without a label.
void keepLabel(const std::string& label, bool without_label, ObjectDetections& detections);

}  // namespace perception
