#include "libperception/importers/messages/MessageFields.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "libperception/interop/ros/RosSchemas.h"

namespace perception {
namespace {

using ros::Definition;
using ros::RosValue;
using Definitions = std::vector<std::shared_ptr<const Definition>>;

/// The layouts that a topic's messages may have.
Definitions makeDefinitions(const BagTopic& topic) {
  Definitions all;
  if (!topic.definition.empty()) {
    all.push_back(std::make_shared<const Definition>(topic.definition));
    return all;
  }
  // Its messages are those of its successor.
  constexpr std::string_view kFormer = "autoware_auto_perception_msgs";
  std::string type = topic.type;
  if (type.compare(0, kFormer.size(), kFormer) == 0)
    type.replace(0, kFormer.size(), "autoware_perception_msgs");
  for (const char* variant : {"", "~"}) {
    const std::string members = ros::membersOfType(type + variant);
    if (!members.empty()) all.push_back(std::make_shared<const Definition>(members));
  }
  if (all.empty())
    throw std::runtime_error("the recording does not hold the definition of " + topic.type);
  return all;
}

/// Parsed once a type; those of the last hundred are kept.
Definitions definitionsOf(const BagTopic& topic) {
  constexpr std::size_t kMost = 100;
  static std::map<std::pair<std::string, std::string>, Definitions> known;
  const auto key = std::pair(topic.type, topic.definition);
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  if (known.size() >= kMost) known.clear();
  return known[key] = makeDefinitions(topic);
}

}  // namespace

MessageFields fieldsIn(const BagMessage& message) {
  std::string refused;
  for (const auto& definition : definitionsOf(*message.topic)) {
    try {
      return {definition, ros::decoded(message.bytes, message.topic->encoding, *definition),
              ros::decoded<ros::Header>(message.bytes, message.topic->encoding)};
    } catch (const std::runtime_error& e) {
      if (refused.empty()) refused = e.what();
    }
  }
  throw std::runtime_error(refused);
}

std::shared_ptr<const Definition> definitionOf(const BagTopic& topic) {
  return definitionsOf(topic).front();
}

const RosValue* firstOf(const RosValue& value, std::initializer_list<const char*> paths) {
  for (const char* path : paths) {
    if (const RosValue* const found = value.find(path)) return found;
  }
  return nullptr;
}

double firstNumber(const RosValue& value, std::initializer_list<const char*> paths) {
  const RosValue* const found = firstOf(value, paths);
  return found == nullptr || found->numbers.empty() ? std::nan("") : found->numbers[0];
}

std::string_view bytesAt(const RosValue& value, std::string_view path) {
  const RosValue* const found = value.find(path);
  return found == nullptr ? std::string_view() : found->bytes;
}

ros::Pose poseAt(const RosValue& value) {
  ros::Pose pose;
  constexpr std::array<const char*, 3> kPlace = {"position.x", "position.y", "position.z"};
  for (std::size_t i = 0; i < kPlace.size(); ++i) pose.position[i] = value.number(kPlace[i]);
  pose.orientation = {value.number("orientation.x"), value.number("orientation.y"),
                      value.number("orientation.z"), value.number("orientation.w")};
  return pose;
}

double wholeAt(const RosValue& value, std::string_view path, double most) {
  const double number = value.number(path);
  if (!(number >= 0) || number > most)
    throw std::runtime_error(fmt::format("{}: {}", path, number));
  return number;
}

}  // namespace perception
