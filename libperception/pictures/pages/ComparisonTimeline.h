#pragma once
#include <cstddef>
#include <string>

#include "libperception/evaluation/without_truth/RunDifference.h"

namespace perception {

inline constexpr std::size_t kMostComparedRows = 80;  ///< of the timeline: those apart most

/// SVG of the first rows of a difference over time: two bars a row, A above B, in the color of the
/// class; hatched where only one run has the object, pale where the other has no scene.
std::string comparisonTimeline(const RunDifference& difference);

/// Color of a class of the difference, #rrggbb.
std::string hexOfClass(const RunDifference& difference, std::size_t class_index);

}  // namespace perception
