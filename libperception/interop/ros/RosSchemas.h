#pragma once
#include <string>

#include "libperception/interop/bags/McapWriter.h"

namespace perception::ros {

/// Definition of a ROS 2 message as MCAP's registry wants it (ros2msg): its members, then those of
/// every type within. `type`: "sensor_msgs/PointCloud2"; one of those that RosFile.cpp writes.
/// Names and types of members: common_interfaces, geometry2 and vision_msgs of ROS 2.
McapWriter::Schema schemaOf(const std::string& type);

/// The members of a message alone, a line each; empty: the type is not known. Beside those that we
/// write it has the usual parts of other messages, and messages whose definitions sqlite files of
/// rosbag2 do not hold: of autoware_perception_msgs, derived_object_msgs (ROS packages of
/// AutonomouStuff), ros2_socketcan_msgs, oxts_msgs. "~" behind a type: another layout that is in
/// use.
std::string membersOfType(const std::string& type);

}  // namespace perception::ros
