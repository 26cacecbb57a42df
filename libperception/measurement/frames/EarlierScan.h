#pragma once
#include <memory>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/frames/PlacedReturns.h"

namespace perception {

/// The scan before, of the same lidar: for what has moved since.
struct EarlierScan {
  Stamp stamp;
  Pose3 T_world_ego = Pose3::Identity();
  std::shared_ptr<const PlacedReturns> returns;  ///< never null
};

}  // namespace perception
