#pragma once
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// [px^2] that two boxes share.
double sharedArea(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);
double areaOf(const ObjectDetection::ImageBox& box);
/// Intersection over union, [0, 1].
double overlapOf(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);

/// The best box of each object, best first: weaker ones of its label that overlap a better one by
/// more than `overlap` (intersection over union) go.
std::vector<ObjectDetection> suppressed(std::vector<ObjectDetection> objects, double overlap);

}  // namespace perception
