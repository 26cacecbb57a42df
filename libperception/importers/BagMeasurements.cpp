#include "libperception/importers/BagMeasurements.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationIMU.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "libperception/importers/ImportGps.h"
#include "libperception/interop/RosSensors.h"
#include "libperception/sensors/Conversions.h"

namespace perception {
namespace {

constexpr const char* kFix = "sensor_msgs/NavSatFix";
constexpr const char* kImu = "sensor_msgs/Imu";

BagType::Role roleOf(const BagTopic& topic) {
  const BagType* const type = bagType(topic.type);
  return type != nullptr && topic.unknown_encoding.empty() ? type->role : BagType::Role::kOther;
}

bool isOuster(const BagTopic& topic) {
  constexpr std::string_view kEnd = "/PacketMsg";
  return topic.type.size() > kEnd.size() &&
         topic.type.substr(topic.type.size() - kEnd.size()) == kEnd;
}

/// MRPT's class; absent parts (ROS: a covariance that begins with -1) stay absent.
std::shared_ptr<mrpt::obs::CObservation> imuObservation(const ros::Imu& imu,
                                                        const std::string& label) {
  using namespace mrpt::obs;
  auto out = std::make_shared<CObservationIMU>();
  out->timestamp = fromStamp(imu.header.stamp);
  out->sensorLabel = label;
  if (imu.rates_covariance[0] >= 0) {
    out->set(IMU_WX, imu.rates[0]);
    out->set(IMU_WY, imu.rates[1]);
    out->set(IMU_WZ, imu.rates[2]);
  }
  if (imu.force_covariance[0] >= 0) {
    out->set(IMU_X_ACC, imu.force[0]);
    out->set(IMU_Y_ACC, imu.force[1]);
    out->set(IMU_Z_ACC, imu.force[2]);
  }
  return out;
}

}  // namespace

std::string labelOfTopic(const std::string& topic) {
  std::string label = topic.substr(
      topic.find_first_not_of('/') == std::string::npos ? 0 : topic.find_first_not_of('/'));
  for (const char separator : {'/', '.'}) std::replace(label.begin(), label.end(), separator, '_');
  return label;
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
      const bool silent = isOuster(row.topic) && contents.lidar_packets.count(name) == 0;
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
  if (params.label.empty()) params.label = labelOfTopic(topic);
  return params;
}

bool BagMeasurements::uses(const BagTopic& topic) const {
  if (!topic.unknown_encoding.empty()) return false;
  const auto given = topics_.find(topic.name);
  // Boxes may be another tracker's output: they are read when they are asked for.
  return given == topics_.end() ? roleOf(topic) != BagType::Role::kBoxes : given->second.use;
}

bool BagMeasurements::isPlaced(const std::string& topic, const ros::Header& header) const {
  return placeOf(header, paramsOf(topic)).has_value();
}

void BagMeasurements::take(const BagMessage& message) {
  const BagTopic& topic = *message.topic;
  if (!uses(topic)) return;
  const BagTopicParams params = paramsOf(topic.name);
  if (roleOf(topic) != BagType::Role::kOther) return takeSensor(message, params);
  if (topic.type == kFix) return takeFix(message, params);
  if (topic.type == kImu) return takeImu(message, params);
}

void BagMeasurements::takeFix(const BagMessage& message, const BagTopicParams& params) {
  auto fix = ros::decoded<ros::NavSatFix>(message.bytes, message.topic->encoding);
  fix.header.stamp = fix.header.stamp + shiftOf(message);
  if (fix.status < 0 || !std::isfinite(fix.latitude + fix.longitude)) return;
  const double altitude = std::isfinite(fix.altitude) ? fix.altitude : 0;
  auto out =
      gpsObservation({fix.header.stamp, fix.latitude, fix.longitude, altitude}, params.label);
  out->setSensorPose(toMrpt(mounting(fix.header, params)));
  outputs_.observation(fix.header.stamp, std::move(out));
}

void BagMeasurements::takeImu(const BagMessage& message, const BagTopicParams& params) {
  auto imu = ros::decoded<ros::Imu>(message.bytes, message.topic->encoding);
  imu.header.stamp = imu.header.stamp + shiftOf(message);
  auto out = imuObservation(imu, params.label);
  out->setSensorPose(toMrpt(mounting(imu.header, params)));
  outputs_.observation(imu.header.stamp, std::move(out));
}

/// A sensor's message, or a part of one turn of a lidar in packets.
void BagMeasurements::takeSensor(const BagMessage& message, const BagTopicParams& params) {
  const BagType& type = *bagType(message.topic->type);
  if (type.unpack != nullptr) {
    auto& packets = packets_[message.topic->name];
    if (!packets)
      packets = std::make_unique<BagPackets>(
          type, params.label, metadataFor(message.topic->name),
          [this, params, topic = message.topic->name, shift = shiftOf(message)](
              ros::Header header, SensorFrame&& scan) {
            header.stamp = header.stamp + shift;
            takeFrame(topic, header, params, std::move(scan));
          });
    return packets->add(message);
  }
  SensorFrame frame;
  ros::Header header = type.measure(message, params, frame);
  header.stamp = header.stamp.ns <= 0 ? message.stamp : header.stamp + shiftOf(message);
  if (auto* const image = std::get_if<CameraImage>(&frame.data)) {
    const CameraModel own = image->camera;
    image->camera = cameraBeside(message.topic->name).value_or(own);
    image->camera.width = own.width, image->camera.height = own.height;
  }
  takeFrame(message.topic->name, header, params, std::move(frame));
}

void BagMeasurements::takeFrame(const std::string& topic, const ros::Header& header,
                                const BagTopicParams& params, SensorFrame&& frame) {
  const std::string other = otherFrame(topic, header);
  frame.sensor = other.empty() ? params.label : params.label + "_" + labelOfTopic(other);
  frame.stamp = header.stamp;
  frame.T_ego_sensor = mounting(header, params);
  outputs_.frame(topic, other.empty(), std::move(frame));
}

/// The metadata topic with the longest beginning in common.
std::string BagMeasurements::metadataFor(const std::string& topic) const {
  std::string best;
  std::size_t longest = 0;
  for (const auto& [name, text] : contents_.metadata) {
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

std::optional<CameraModel> BagMeasurements::cameraBeside(const std::string& topic) const {
  for (std::string folder = topic; folder.rfind('/') != std::string::npos;) {
    folder.erase(folder.rfind('/'));
    const auto info = contents_.cameras.find(folder + "/camera_info");
    if (info == contents_.cameras.end()) continue;
    return ros::cameraOf(info->second, topic.find("rect") != std::string::npos);
  }
  return {};
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

void BagMeasurements::finish() {
  for (const auto& row : packets_) row.second->finish();
}

std::vector<std::string> BagMeasurements::warnings() const {
  std::vector<std::string> all;
  for (const auto& row : packets_) {
    for (const std::string& warning : row.second->warnings()) all.push_back(warning);
  }
  for (const std::string& frame : unplaced_)
    all.push_back(
        fmt::format("frame \"{}\" has no transform to the vehicle's frame \"{}\": taken to be "
                    "there ([topic.TOPIC] pose says where it is)",
                    frame, base_));
  return all;
}

}  // namespace perception
