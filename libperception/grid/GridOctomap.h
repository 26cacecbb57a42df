#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Cells in space, in an octree of OctoMap [hornung2013], so that a
/// bridge or a branch does not hide the road below. Each cell carries the time of its last change
/// and decays when it is touched or read.
std::unique_ptr<SafetyGrid> makeGridOctomap(const GridParams& params);

}  // namespace perception
