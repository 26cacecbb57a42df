#pragma once
#include <initializer_list>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/RosDefinition.h"
#include "libperception/interop/ros/RosMessages.h"

namespace perception {

/// A message by the names of its fields; valid as long as the message. All throw
/// std::runtime_error.
struct MessageFields {
  std::shared_ptr<const ros::Definition> definition;
  ros::RosValue value;
  ros::Header header;
};

/// By the definition that travels with the recording, else by the known layout (RosSchemas.h) that
/// fits the message's length.
MessageFields fieldsIn(const BagMessage& message);

/// The definition that travels with a topic.
std::shared_ptr<const ros::Definition> definitionOf(const BagTopic& topic);

/// The first of the paths that is there; null: none.
const ros::RosValue* firstOf(const ros::RosValue& value, std::initializer_list<const char*> paths);
/// NaN: none.
double firstNumber(const ros::RosValue& value, std::initializer_list<const char*> paths);
std::string_view bytesAt(const ros::RosValue& value, std::string_view path);
/// The members of geometry_msgs/Pose.
ros::Pose poseAt(const ros::RosValue& value);
/// Throws std::runtime_error: it is not in 0 to `most`.
double wholeAt(const ros::RosValue& value, std::string_view path, double most);
template <class Number>
Number wholeAt(const ros::RosValue& value, std::string_view path) {
  return static_cast<Number>(
      wholeAt(value, path, static_cast<double>(std::numeric_limits<Number>::max())));
}

}  // namespace perception
