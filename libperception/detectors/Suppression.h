#pragma once
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Area of the intersection of two boxes [px^2].
double sharedArea(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);
double areaOf(const ObjectDetection::ImageBox& box);
/// Intersection over union, [0, 1].
double overlapOf(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);

/// Non-maximum suppression, best first, within each label: removes weaker boxes that overlap a
/// better one by more than `overlap` (intersection over union).
std::vector<ObjectDetection> suppressed(std::vector<ObjectDetection> objects, double overlap);

}  // namespace perception
