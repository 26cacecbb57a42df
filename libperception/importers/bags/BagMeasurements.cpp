#include "libperception/importers/bags/BagMeasurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "libperception/importers/bags/MoveReturns.h"
#include "libperception/interop/ros/RosSensors.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

BagType::Role roleOf(const BagTopic& topic) {
  const BagType* const type = bagType(topic);
  return type != nullptr ? type->role : BagType::Role::kOther;
}

}  // namespace

std::string labelOfTopic(const std::string& topic) {
  std::string label = topic.substr(
      topic.find_first_not_of('/') == std::string::npos ? 0 : topic.find_first_not_of('/'));
  for (const char separator : {'/', '.'}) std::replace(label.begin(), label.end(), separator, '_');
  return label;
}

std::string labelOfTopic(const std::string& topic, const BagContents& contents) {
  std::string label = labelOfTopic(topic);
  int number = 1;
  for (const auto& [other, row] : contents.topics) {
    if (other == topic) break;
    if (labelOfTopic(other) == label && bagType(row.topic) != nullptr) ++number;
  }
  return number == 1 ? label : fmt::format("{}_{}", label, number);
}

std::string namedBaseFrameOf(const BagParams& params, const BagContents& contents) {
  std::string base = params.base_frame;
  for (const char* usual : {"base_footprint", "base_link", "ego", "vehicle"}) {
    if (base.empty() && contents.tree.has(usual)) base = usual;
  }
  return base;
}

std::string baseFrameOf(const BagParams& params, const BagContents& contents) {
  std::string base = namedBaseFrameOf(params, contents);
  if (base.empty() && !contents.tree.moving().empty()) base = contents.tree.moving().front();
  for (const auto& row : contents.poses) {
    if (base.empty()) base = row.second.frame;
  }
  return base;
}

std::string framesTopicOf(const BagTopicParamsByName& topics, const BagContents& contents) {
  using Role = BagType::Role;
  for (const Role wanted : {Role::kCloud, Role::kRadar, Role::kImage, Role::kBoxes}) {
    for (const auto& [name, row] : contents.topics) {
      const auto params = topics.find(name);
      const bool used = params == topics.end() ? wanted != Role::kBoxes : params->second.use;
      const BagType* const type = bagType(row.topic);
      const bool silent =
          type != nullptr && type->may_be_silent && contents.device_topics.count(name) == 0;
      if (used && !silent && roleOf(row.topic) == wanted) return name;
    }
  }
  return "";
}

BagMeasurements::BagMeasurements(const BagContents& contents, const BagTopicParamsByName& topics,
                                 Outputs outputs)
    : contents_(contents), topics_(topics), outputs_(std::move(outputs)) {}

void BagMeasurements::setBase(const std::string& frame, const Pose3& T_ego_base) {
  base_ = frame;
  T_ego_base_ = T_ego_base;
}

BagTopicParams BagMeasurements::paramsOf(const std::string& topic) const {
  const auto given = topics_.find(topic);
  BagTopicParams params = given == topics_.end() ? BagTopicParams() : given->second;
  if (params.label.empty()) params.label = labelOfTopic(topic, contents_);
  return params;
}

bool BagMeasurements::uses(const BagTopic& topic) const {
  const BagType* const type = bagType(topic);
  if (type == nullptr) return false;
  const auto given = topics_.find(topic.name);
  // Boxes may be another tracker's output: they are read when they are asked for.
  return given == topics_.end() ? type->role != BagType::Role::kBoxes : given->second.use;
}

bool BagMeasurements::isPlaced(const std::string& topic, const ros::Header& header) const {
  return placeOf(header, paramsOf(topic)).has_value();
}

void BagMeasurements::take(const BagMessage& message) {
  const BagTopic& topic = *message.topic;
  if (!uses(topic)) return;
  const BagType& type = *bagType(topic);
  const BagTopicParams params = paramsOf(topic.name);
  if (type.role != BagType::Role::kOther) return takeSensor(message, type, params);
  if (type.observe != nullptr) takeReading(message, type, params);
}

void BagMeasurements::takeReading(const BagMessage& message, const BagType& type,
                                  const BagTopicParams& params) {
  ros::Header header;
  auto out = type.observe(message, shiftOf(message), header);
  if (!out) return;
  if (type.of_vehicle && frameName(header.frame_id) != base_) {
    foreign_.emplace(message.topic->name, frameName(header.frame_id));
    return;
  }
  header.stamp = header.stamp + shiftOf(message);
  out->sensorLabel = params.label;
  out->setSensorPose(toMrpt(mounting(header, params)));
  outputs_.observation(header.stamp, std::move(out));
}

/// A sensor's message, or a part of one turn of a lidar in packets.
void BagMeasurements::takeSensor(const BagMessage& message, const BagType& type,
                                 const BagTopicParams& params) {
  if (type.unpack != nullptr) return takePackets(message, type, params);
  SensorFrame frame;
  ros::Header header = type.measure(message, params, frame);
  header.stamp = header.stamp.ns <= 0 ? message.stamp : header.stamp + shiftOf(message);
  setCamera(message.topic->name, header, frame);
  takeFrame(message.topic->name, header, params, std::move(frame));
}

void BagMeasurements::takePackets(const BagMessage& message, const BagType& type,
                                  const BagTopicParams& params) {
  const auto header = headerOf(message);
  auto& packets = packets_[{message.topic->name, header ? frameName(header->frame_id) : ""}];
  if (!packets)
    packets = std::make_unique<BagPackets>(
        type, params.label, metadataFor(message.topic->name, type),
        [this, params, topic = message.topic->name, shift = shiftOf(message)](ros::Header header,
                                                                              SensorFrame&& scan) {
          header.stamp = header.stamp + shift;
          takeFrame(topic, header, params, std::move(scan));
        });
  packets->add(message);
}

void BagMeasurements::takeFrame(const std::string& topic, const ros::Header& header,
                                const BagTopicParams& params, SensorFrame&& frame) {
  if (std::holds_alternative<RadarReturns>(frame.data)) radars_.insert(topic);
  const auto* const cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud != nullptr && cloud->size() == 0 && radars_.count(topic) > 0)
    frame.data = RadarReturns();  // a cloud without returns may have no fields that say what it is
  const std::string other = otherFrame(topic, header);
  frame.sensor = other.empty() ? params.label : params.label + "_" + labelOfTopic(other);
  frame.stamp = header.stamp;
  place(topic, header, params, frame);
  outputs_.frame(topic, other.empty(), std::move(frame));
}

/// What the topic with the longest beginning in common says of a device.
std::string BagMeasurements::metadataFor(const std::string& topic, const BagType& type) const {
  if (type.device_files == nullptr) return "";
  std::string best;
  std::size_t longest = 0;
  for (const auto& [name, text] : contents_.*type.device_files) {
    const auto common = static_cast<std::size_t>(
        std::mismatch(name.begin(), name.end(), topic.begin(), topic.end()).first - name.begin());
    if (best.empty() || common > longest) best = text, longest = common;
  }
  return best;
}

/// [s] to be added to a message's stamp.
double BagMeasurements::shiftOf(const BagMessage& message) const {
  const auto clock = contents_.clocks.find(message.topic->name);
  return clock == contents_.clocks.end() ? 0 : clock->second.shift;
}

/// A frame of reference besides the first one of the topic; empty: it is the first.
std::string BagMeasurements::otherFrame(const std::string& topic, const ros::Header& header) const {
  const auto frames = contents_.frames.find(topic);
  const std::string name = frameName(header.frame_id);
  const bool first = frames == contents_.frames.end() || frames->second.front() == name;
  return first ? "" : name.empty() ? "without_frame" : name;
}

/// The camera's calibration in the topic's folder, or in one above it; else that of the same frame.
std::optional<CameraModel> BagMeasurements::cameraFor(const std::string& topic,
                                                      const std::string& frame) const {
  const bool rectified = topic.find("rect") != std::string::npos;
  for (std::string folder = topic; folder.rfind('/') != std::string::npos;) {
    folder.erase(folder.rfind('/'));
    const auto info = contents_.cameras.find(folder + "/camera_info");
    if (info != contents_.cameras.end()) return ros::cameraOf(info->second, rectified);
  }
  for (const auto& row : contents_.cameras) {
    if (!frame.empty() && frameName(row.second.header.frame_id) == frame)
      return ros::cameraOf(row.second, rectified);
  }
  return {};
}

void BagMeasurements::setCamera(const std::string& topic, const ros::Header& header,
                                SensorFrame& frame) const {
  const auto camera = cameraFor(topic, frameName(header.frame_id));
  if (auto* const image = std::get_if<CameraImage>(&frame.data); image != nullptr && camera) {
    const CameraModel own = image->camera;
    image->camera = *camera;
    image->camera.width = own.width, image->camera.height = own.height;
  }
  if (auto* const boxes = std::get_if<ObjectDetections>(&frame.data); boxes != nullptr && camera)
    boxes->camera = *camera;
}

std::optional<Pose3> BagMeasurements::placeOf(const ros::Header& header,
                                              const BagTopicParams& params) const {
  if (!params.pose.empty()) return poseOfNumbers(params.pose);
  const std::string frame = frameName(header.frame_id);
  if (frame == base_) return T_ego_base_;
  if (const auto T = contents_.tree.at(base_, frame, header.stamp)) return T_ego_base_ * *T;
  return {};
}

Pose3 BagMeasurements::mounting(const ros::Header& header, const BagTopicParams& params) {
  const auto place = placeOf(header, params);
  if (!place) unplaced_.insert(frameName(header.frame_id));
  return place.value_or(T_ego_base_);
}

/// Whether the vehicle travels in the message's frame, by the transforms or else by its name.
bool BagMeasurements::isOfWorld(const ros::Header& header, const BagTopicParams& params) const {
  const std::string frame = frameName(header.frame_id);
  if (contents_.tree.travelsIn(frame, base_)) return true;
  return isNamedAsWorld(frame) && !placeOf(header, params);
}

/// Sets the sensor's place on the vehicle. Returns that programs moved into a frame of the world
/// are moved back: to the place that the parameters say, else to the vehicle's frame.
void BagMeasurements::place(const std::string& topic, const ros::Header& header,
                            const BagTopicParams& params, SensorFrame& frame) {
  const std::string world = frameName(header.frame_id);
  const bool returns = std::holds_alternative<LidarCloud>(frame.data) ||
                       std::holds_alternative<RadarReturns>(frame.data);
  if (!returns || !isOfWorld(header, params)) {
    frame.T_ego_sensor = mounting(header, params);
    return;
  }
  const auto T_base_world = contents_.tree.at(base_, world, header.stamp);
  if (!T_base_world)
    throw std::runtime_error(
        fmt::format("it is in the fixed frame \"{}\", in which the pose of the vehicle \"{}\" at "
                    "that time is not known (if the sensor stands there: [topic.{}] pose)",
                    world, base_, topic));
  frame.T_ego_sensor = params.pose.empty() ? T_ego_base_ : poseOfNumbers(params.pose);
  moveReturns(frame.T_ego_sensor.inverse() * T_ego_base_ * *T_base_world, frame);
  moved_[topic] = {world, !params.pose.empty()};
}

void BagMeasurements::finish() {
  for (const auto& row : packets_) row.second->finish();
}

std::vector<std::string> BagMeasurements::notes() const {
  std::vector<std::string> all;
  for (const auto& [topic, moved] : moved_)
    all.push_back(
        fmt::format("{}: its returns are in the fixed frame \"{}\": moved back to the "
                    "vehicle by its poses",
                    topic, moved.first));
  return all;
}

std::vector<std::string> BagMeasurements::warnings() const {
  std::vector<std::string> all;
  for (const auto& [topic, moved] : moved_)
    if (!moved.second)
      all.push_back(fmt::format(
          "{}: its messages do not say where the sensor is on the vehicle: taken to be at \"{}\" "
          "([topic.{}] pose says where it is)",
          topic, base_, topic));
  for (const auto& row : packets_) {
    for (const std::string& warning : row.second->warnings()) all.push_back(warning);
  }
  for (const auto& [topic, frame] : foreign_)
    all.push_back(fmt::format("{}: speeds in frame \"{}\", not in the vehicle's \"{}\": left out",
                              topic, frame, base_));
  for (const std::string& frame : unplaced_)
    all.push_back(
        fmt::format("frame \"{}\" has no transform to the vehicle's frame \"{}\": taken to be "
                    "there ([topic.TOPIC] pose says where it is)",
                    frame, base_));
  return all;
}

}  // namespace perception
