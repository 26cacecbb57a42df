#pragma once
#include <vector>

#include "libperception/detectors/dpm/DpmEngine.h"

namespace perception {

/// [px^2] that two boxes share.
double sharedArea(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);
double areaOf(const ObjectDetection::ImageBox& box);
/// Intersection over union, [0, 1].
double overlapOf(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b);

/// The best place of each object, best first: weaker ones of a target of which more than `overlap`
/// lies inside a better one go. Headings are then means of the components that fit the kept box,
/// which lie finer than the components do.
std::vector<DpmDetection> suppressed(std::vector<DpmDetection> places, double overlap);

/// The same for any detector's boxes, within each label.
std::vector<ObjectDetection> suppressed(std::vector<ObjectDetection> objects, double overlap);

}  // namespace perception
