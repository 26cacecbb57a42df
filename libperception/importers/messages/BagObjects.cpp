#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "libperception/importers/messages/BagFields.h"
#include "libperception/importers/messages/MessageFields.h"
#include "libperception/interop/ros/RosDefinition.h"
#include "libperception/interop/ros/RosSensors.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/radars/CanBundle.h"

namespace perception {
namespace {

using ros::RosValue;

/// x and y of a message, or of the words by which Continental names them.
Vector2 along(const RosValue& value, std::initializer_list<const char*> messages,
              std::initializer_list<const char*> ahead, std::initializer_list<const char*> aside) {
  if (const RosValue* const of = firstOf(value, messages); of != nullptr && of->part != nullptr)
    return {of->number("x"), of->number("y")};
  return {firstNumber(value, ahead), firstNumber(value, aside)};
}

ObjectDetection::SpaceBox spaceBox(const ros::Pose& pose, const Vector3& size) {
  const Pose3 center = poseOf(pose);
  ObjectDetection::SpaceBox box;
  box.bottom_center = center * Vector3(0, 0, -size.z() / 2);
  box.yaw = yawOf(center);
  box.length = size.x(), box.width = size.y(), box.height = size.z();
  if (!size.allFinite()) throw std::runtime_error("a box without a size");
  return box;
}

const std::vector<RosValue>& itemsOf(const MessageFields& fields, const char* list) {
  const RosValue* const found = fields.value.find(list);
  if (found == nullptr) throw std::runtime_error(fmt::format("no {} in it", list));
  return found->items;
}

}  // namespace

ros::Header measureRadarList(const BagMessage& m, const BagTopicParams& params,
                             SensorFrame& frame) {
  const MessageFields fields = fieldsIn(m);
  const RosValue* list = firstOf(fields.value, {"objects", "clusters", "points", "tracks",
                                                "targets", "detections", "contiobs"});
  if (list == nullptr) throw std::runtime_error("no list of objects or clusters in it");
  RadarReturns radar;
  for (const RosValue& item : list->items) {
    const Vector2 place =
        along(item, {"position.pose.position", "pose.pose.position", "pose.position", "position"},
              {"dist_long", "longitude_dist", "x"}, {"dist_lat", "lateral_dist", "y"});
    const Vector2 velocity =
        along(item, {"relative_velocity.twist.linear", "twist.twist.linear", "velocity"},
              {"vrel_long", "longitude_vel", "vx"}, {"vrel_lat", "lateral_vel", "vy"});
    if (!place.allFinite()) throw std::runtime_error("an object without a known name of its place");
    RadarReturn r;
    r.range = place.norm(), r.bearing = std::atan2(place.y(), place.x());
    const double rate = velocity.dot(place) / r.range;
    r.has_rate = params.rate_scale != 0 && std::isfinite(rate);
    r.range_rate = r.has_rate ? params.rate_scale * rate : 0;
    if (const double rcs = firstNumber(item, {"rcs", "amplitude"}); std::isfinite(rcs))
      r.amplitude = rcs;
    const double id = firstNumber(item, {"id", "obj_id", "obstacle_id", "track_id"});
    if (id >= 0 && id < 1e9) r.id = static_cast<std::int32_t>(id);
    radar.returns.push_back(r);
  }
  frame.data = std::move(radar);
  return fields.header;
}

ros::Header measureAutoware(const BagMessage& m, const BagTopicParams&, SensorFrame& frame) {
  static constexpr std::array<const char*, 8> kNames = {
      "unknown", "car", "truck", "bus", "trailer", "motorcycle", "bicycle", "pedestrian"};
  const MessageFields fields = fieldsIn(m);
  ObjectDetections out;
  for (const RosValue& item : itemsOf(fields, "objects")) {
    ObjectDetection object;
    object.label = kNames[0];
    object.score = item.number("existence_probability");
    double best = 0;
    if (const RosValue* const classes = item.find("classification")) {
      for (const RosValue& c : classes->items) {
        const auto label = wholeAt<std::uint8_t>(c, "label");
        const char* const name = label < kNames.size() ? kNames[label] : kNames[0];
        object.class_scores.emplace_back(name, c.number("probability"));
        if (c.number("probability") > best) best = c.number("probability"), object.label = name;
      }
    }
    const RosValue* const pose = item.find("kinematics.pose_with_covariance.pose");
    const RosValue* const size = item.find("shape.dimensions");
    if (pose == nullptr || size == nullptr) throw std::runtime_error("an object without a box");
    object.space_box =
        spaceBox(poseAt(*pose), {size->number("x"), size->number("y"), size->number("z")});
    out.objects.push_back(std::move(object));
  }
  frame.data = std::move(out);
  return fields.header;
}

ros::Header measureDerivedObjects(const BagMessage& m, const BagTopicParams&, SensorFrame& frame) {
  static constexpr std::array<const char*, 12> kNames = {
      "unknown", "unknown_small", "unknown_medium", "unknown_big", "pedestrian", "bike",
      "car",     "truck",         "motorcycle",     "other",       "barrier",    "sign"};
  constexpr double kCertain = 255;
  constexpr std::size_t kSides = 3;
  const MessageFields fields = fieldsIn(m);
  ObjectDetections out;
  for (const RosValue& item : itemsOf(fields, "objects")) {
    const RosValue* const pose = firstOf(item, {"pose.pose", "pose"});
    const RosValue* const size = item.find("shape.dimensions");
    // Of a box alone: cylinders and spheres have other numbers.
    if (pose == nullptr || size == nullptr || size->numbers.size() < kSides) continue;
    ObjectDetection object;
    const auto kind = wholeAt<std::uint8_t>(item, "classification");
    object.label = kind < kNames.size() ? kNames[kind] : kNames[0];
    object.score = item.number("classification_certainty") / kCertain;
    object.space_box =
        spaceBox(poseAt(*pose), {size->numbers[0], size->numbers[1], size->numbers[2]});
    out.objects.push_back(std::move(object));
  }
  frame.data = std::move(out);
  return fields.header;
}

ros::Header measureImageBoxes(const BagMessage& m, const BagTopicParams&, SensorFrame& frame) {
  const MessageFields fields = fieldsIn(m);
  ObjectDetections out;
  for (const RosValue& item : itemsOf(fields, "detections")) {
    ObjectDetection object;
    object.label = "object";
    if (const RosValue* const results = item.find("results")) {
      for (const RosValue& result : results->items) {
        const RosValue* const nested = result.find("hypothesis");
        const RosValue& h = nested != nullptr ? *nested : result;
        const std::string name = h.text(h.find("class_id") != nullptr ? "class_id" : "id");
        const double score = h.number("score");
        object.class_scores.emplace_back(name, score);
        if (object.class_scores.size() == 1 || score > object.score)
          object.label = name, object.score = score;
      }
    }
    const double x = firstNumber(item, {"bbox.center.position.x", "bbox.center.x"});
    const double y = firstNumber(item, {"bbox.center.position.y", "bbox.center.y"});
    const double w = item.number("bbox.size_x") / 2, h = item.number("bbox.size_y") / 2;
    if (!std::isfinite(x + y + w + h)) throw std::runtime_error("a detection without a box");
    object.image_box = ObjectDetection::ImageBox{x - w, y - h, x + w, y + h};
    out.objects.push_back(std::move(object));
  }
  frame.data = std::move(out);
  return fields.header;
}

ros::Header unpackEsrTrack(const BagMessage& m, std::vector<BagPacket>& packets) {
  constexpr double kTracks = 64;
  constexpr std::uint32_t kFirstTrack = 0x500, kStatus = 0x4E0, kUpdated = 3;
  const MessageFields fields = fieldsIn(m);
  const double id = firstNumber(fields.value, {"id", "track_id", "track_ID"});
  const double range = fields.value.number("range"), angle = fields.value.number("angle");
  const double rate = fields.value.number("range_rate"), status = fields.value.number("status");
  if (!(id >= 1 && id <= kTracks) || !std::isfinite(range + angle + rate))
    throw std::runtime_error("a track without number, range, angle and range_rate");
  const auto steps = [](double value, double unit, double least, double most) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(value / unit, least, most)));
  };
  std::string data(8, '\0');
  putBitsMsbFirst(data, 8, 3,
                  status >= 0 && status < 8 ? static_cast<std::uint32_t>(status) : kUpdated);
  putBitsMsbFirst(data, 11, 10, steps(angle, .1, -512, 511) & 0x3FFU);
  putBitsMsbFirst(data, 21, 11, steps(range, .1, 0, 2047));
  putBitsMsbFirst(data, 50, 14, steps(rate, .01, -8192, 8191) & 0x3FFFU);
  if (id == 1) {  // a scan begins
    std::string begin(8, '\0');
    constexpr std::int64_t kTick = 10'000'000;  // [ns] shorter than a scan
    putBig(begin, 3, static_cast<std::uint64_t>(fields.header.stamp.ns / kTick) & 0xFFFFU, 2);
    packets.push_back({canMessage(kStatus, begin), fields.header.stamp});
    // Drivers may leave out tracks without a target.
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(kTracks); ++i)
      packets.push_back(
          {canMessage(kFirstTrack + i, std::string(data.size(), '\0')), fields.header.stamp});
  }
  packets.push_back(
      {canMessage(kFirstTrack + static_cast<std::uint32_t>(id) - 1, data), fields.header.stamp});
  return fields.header;
}

}  // namespace perception
