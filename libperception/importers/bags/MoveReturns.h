#pragma once
#include <string>

#include "libperception/core/Frames.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Whether a frame has one of the names that ROS's REP 105 gives to those that stand in the world.
bool isNamedAsWorld(const std::string& frame);

/// The returns of a lidar or radar in another frame, by the pose of their own frame in it. Range
/// rates are those of the radar wherever it is. Other data stay as they are.
void moveReturns(const Pose3& T_to_from, SensorFrame& frame);

}  // namespace perception
