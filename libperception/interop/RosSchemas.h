#pragma once
#include <string>

#include "libperception/interop/McapWriter.h"

namespace perception::ros {

/// Definition of a ROS 2 message as MCAP's registry wants it (ros2msg): its members, then those of
/// every type within. `type`: "sensor_msgs/PointCloud2"; one of those that RosFile.cpp writes.
/// Names and types of members: common_interfaces, geometry2 and vision_msgs of ROS 2.
McapWriter::Schema schemaOf(const std::string& type);

}  // namespace perception::ros
