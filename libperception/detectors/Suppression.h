#pragma once
#include <vector>

#include "libperception/detectors/dpm/DpmEngine.h"

namespace perception {

/// Area of the intersection of two boxes [px^2].
double sharedArea(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);
double areaOf(const ObjectDetection::ImageBox& box);
/// Intersection over union, [0, 1].
double overlapOf(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);

/// Non-maximum suppression, best first: removes weaker detections of a target with more than
/// `overlap` of their area inside a better one. Headings become means over the components that fit
/// the kept box, finer than the components' spacing.
std::vector<DpmDetection> suppressed(std::vector<DpmDetection> places, double overlap);

/// The same for any detector's boxes, within each label.
std::vector<ObjectDetection> suppressed(std::vector<ObjectDetection> objects, double overlap);

}  // namespace perception
