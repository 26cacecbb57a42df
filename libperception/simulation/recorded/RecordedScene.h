#pragma once
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {

/// Pose of the vehicle at a time of a recording.
struct RecordedPose {
  double t = 0;  ///< [s] since the log's first stamp
  Pose3 T_world_ego = Pose3::Identity();
};

/// The scene of a recording as far as weather needs it, on a flat road: the vehicle's path and the
/// road users of the truth, which whirl up spray, blow exhaust, and are seen again in puddles.
/// Objects keep the mean of their sizes; those whose truth moves less than 1 m are parked. Without
/// poses the vehicle stands at the origin.
Scenario recordedScene(const GroundTruth& truth, const std::vector<RecordedPose>& poses,
                       double duration);

}  // namespace perception
