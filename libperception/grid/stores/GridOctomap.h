#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// 3D grid in an OctoMap octree [hornung2013], so that a bridge or a branch does not block the road
/// below. Each cell stores the time of its last change and decays when it is updated or read.
std::unique_ptr<SafetyGrid> makeGridOctomap(const GridParams& params);

}  // namespace perception
