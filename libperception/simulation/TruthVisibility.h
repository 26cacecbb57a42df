#pragma once
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"

namespace perception {

/// Sets occlusion and truncation of truth rows at time t [s], and the time of `caster`. Occlusion
/// (KITTI's levels 0 to 3) is that seen from the first lidar, else from the first sensor that looks
/// around; truncation [0, 1] is the least of all cameras, 0 without cameras. The id of a row is the
/// number of its object in the world plus 1.
void setVisibility(const World& world, LidarCaster& caster, double t,
                   std::vector<TruthObject>& rows);

}  // namespace perception
