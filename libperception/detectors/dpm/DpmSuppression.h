#pragma once
#include <vector>

#include "libperception/detectors/dpm/DpmEngine.h"

namespace perception {

/// The best place of each object, best first: weaker ones of a target of which more than `overlap`
/// lies inside a better one go. Headings are then means of the components that fit the kept box,
/// which lie finer than the components do.
std::vector<DpmDetection> suppressed(std::vector<DpmDetection> places, double overlap);

}  // namespace perception
