#pragma once
#include <string>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Label of boxes without a class. A configuration that accepts such boxes lists it in its labels.
inline constexpr const char* kNoLabel = "unknown";

/// Corruption of a detector's labels, per object with this probability.
struct LabelNoise {
  enum Kind { kNone, kDropped, kFlipped } kind = kNone;
  double probability = 0;  ///< 1 with kDropped: all labels are removed
};

/// Boxes of different labels within `group_distance` [m] are of one object. A corrupted object
/// keeps only its box of highest score; its label becomes kNoLabel (dropped) or a uniformly drawn
/// other one (flipped). Objects corrupted at one probability are also corrupted at any larger one.
void corruptLabels(const LabelNoise& damage, const std::vector<std::string>& labels,
                   double group_distance, const RngKey& key, ObjectDetections& detections);

/// Keeps the boxes of one label and, with `without_label`, those of kNoLabel.
void keepLabel(const std::string& label, bool without_label, ObjectDetections& detections);

}  // namespace perception
