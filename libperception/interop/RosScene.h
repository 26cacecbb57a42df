#pragma once
#include <string>
#include <vector>

#include "libperception/interop/RosMessages.h"
#include "libperception/scene/Scene.h"

namespace perception::ros {

// Frames of ROS's REP 105.
inline constexpr const char* kWorld = "map";
inline constexpr const char* kVehicle = "base_link";

/// The objects' boxes in the frame map; classes with their probability times that of the object's
/// existence, those below .01 left out.
Detection3DArray messageOf(const Scene& scene, const std::vector<std::string>& class_names);

}  // namespace perception::ros
