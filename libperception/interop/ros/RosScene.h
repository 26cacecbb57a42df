#pragma once
#include <string>
#include <vector>

#include "libperception/interop/ros/RosMessages.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/scene/Scene.h"

namespace perception::ros {

// Frames of ROS's REP 105.
inline constexpr const char* kWorld = "map";
inline constexpr const char* kVehicle = "base_link";

/// The objects' boxes in the frame map; classes with their probability times that of the object's
/// existence, those below .01 left out.
Detection3DArray messageOf(const Scene& scene, const std::vector<std::string>& class_names);

/// The boxes of a 3D detector: class and score of each are those of its best hypothesis. Boxes
/// without a hypothesis have the class "object" and the score 0. Throws std::runtime_error for a
/// box of another frame than the message's or a pose that cannot be.
ObjectDetections objectsOf(const Detection3DArray& message);

}  // namespace perception::ros
