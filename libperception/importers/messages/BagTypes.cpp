#include "libperception/importers/messages/BagTypes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libperception/importers/bags/BagUnpack.h"
#include "libperception/importers/messages/BagFields.h"
#include "libperception/importers/messages/BagReadings.h"
#include "libperception/interop/ros/RosDevices.h"
#include "libperception/interop/ros/RosScene.h"
#include "libperception/interop/ros/RosSensors.h"

namespace perception {
namespace {

using ros::decoded;
using Role = BagType::Role;

void addPose(BagContents::Poses& to, const ros::Header& header, const ros::Pose& pose,
             const std::string& frame) {
  to.frame = frameName(frame);
  to.poses.add(header.stamp, poseOf(pose));
}

template <class Message>
Message messageIn(const BagMessage& m) {
  return decoded<Message>(m.bytes, m.topic->encoding);
}

void noteOdometry(const BagMessage& m, BagContents& contents) {
  const auto odometry = messageIn<ros::Odometry>(m);
  addPoseOf(m, contents, odometry.header, odometry.pose, odometry.child_frame_id);
}

template <class Message>
void notePose(const BagMessage& m, BagContents& contents) {
  const auto pose = messageIn<Message>(m);
  addPoseOf(m, contents, pose.header, pose.pose, "");
}

/// The last path is the whole one: programs send it again and again as it grows.
void notePath(const BagMessage& m, BagContents& contents) {
  const auto path = messageIn<ros::Path>(m);
  BagContents::Poses& known = contents.poses[m.topic->name];
  known.on_call = true;
  // One that was cut at its beginning adds what is new.
  for (const auto& pose : path.poses) {
    if (known.poses.empty() || known.poses.row(known.poses.size() - 1).stamp < pose.header.stamp)
      addPose(known, pose.header, pose.pose, "");
  }
}

void noteCamera(const BagMessage& m, BagContents& contents) {
  if (contents.cameras.count(m.topic->name) == 0)
    contents.cameras[m.topic->name] = messageIn<ros::CameraInfo>(m);
}

/// Metadata of a device, as Ouster's drivers send it: JSON on a topic of that name.
void noteText(const BagMessage& m, BagContents& contents) {
  if (m.topic->name.find("metadata") != std::string::npos)
    contents.metadata[m.topic->name] = messageIn<ros::Text>(m).text;
}

ros::Header measurePoints(const BagMessage& m, const BagTopicParams& params, SensorFrame& frame) {
  const auto cloud = messageIn<ros::PointCloud2>(m);
  setCloud(cloud, params, frame);
  return cloud.header;
}

ros::Header measureLivox(const BagMessage& m, const BagTopicParams& params, SensorFrame& frame) {
  const auto scan = messageIn<ros::LivoxScan>(m);
  frame.data = ros::cloudOf(scan, params.intensity_max);
  return scan.header;
}

template <class Message>
ros::Header measureRadar(const BagMessage& m, const BagTopicParams& params, SensorFrame& frame) {
  const auto scan = messageIn<Message>(m);
  frame.data = ros::returnsOf(scan, params.rate_scale);
  return scan.header;
}

ros::Header measureBoxes(const BagMessage& m, const BagTopicParams&, SensorFrame& frame) {
  const auto boxes = messageIn<ros::Detection3DArray>(m);
  frame.data = ros::objectsOf(boxes);
  return boxes.header;
}

template <class Message>
ros::Header measureImage(const BagMessage& m, const BagTopicParams&, SensorFrame& frame) {
  const auto message = messageIn<Message>(m);
  setImage(ros::rasterOf(message), frame);
  return message.header;
}

// Rows by what they have.

using Measure = decltype(BagType::measure);
using Note = decltype(BagType::note);

BagType measured(const char* name, const char* use, Role role, Measure measure) {
  return {name, use, role, measure};
}
BagType noted(const char* name, const char* use, Note note) {
  return {name, use, Role::kOther, nullptr, note};
}
BagType observed(const char* name, const char* use, decltype(BagType::observe) observe) {
  BagType type{name, use};
  type.observe = observe;
  type.of_vehicle = observe == &observeSpeed;
  return type;
}
BagType packed(const char* name, const char* use, Role role, Note note,
               decltype(BagType::unpack) unpack, std::vector<const char*> devices) {
  BagType type{name, use, role, nullptr, note, unpack, std::move(devices)};
  type.may_be_silent = note != nullptr;
  return type;
}

constexpr const char* kBoxesUse = "boxes, if the INI has [topic.TOPIC]";
constexpr const char* kPacketsUse = "lidar scans, from packets";
constexpr const char* kRadarListUse = "radar scans: a return an object or cluster, by its fields";

std::vector<BagType> makeTypes() {
  const std::vector<const char*> robosense = {"rs16", "rs32"};
  std::vector<BagType> types = {
      measured("sensor_msgs/PointCloud2", "lidar or radar scans", Role::kCloud, &measurePoints),
      measured("sensor_msgs/PointCloud", "lidar or radar scans", Role::kCloud, &measureOldCloud),
      measured("radar_msgs/RadarScan", "radar scans", Role::kRadar, &measureRadar<ros::RadarScan>),
      measured("radar_msgs/RadarTracks", "radar scans: a return an object", Role::kRadar,
               &measureRadar<ros::RadarTracks>),
      measured("ars_40X/*", kRadarListUse, Role::kRadar, &measureRadarList),
      measured("conti_radar/*", kRadarListUse, Role::kRadar, &measureRadarList),
      measured("vision_msgs/Detection3DArray", kBoxesUse, Role::kBoxes, &measureBoxes),
      measured("vision_msgs/Detection2DArray", "boxes in images, if the INI has [topic.TOPIC]",
               Role::kBoxes, &measureImageBoxes),
      measured("derived_object_msgs/ObjectArray", kBoxesUse, Role::kBoxes, &measureDerivedObjects),
      measured("derived_object_msgs/ObjectWithCovarianceArray", kBoxesUse, Role::kBoxes,
               &measureDerivedObjects),
      measured("sensor_msgs/Image", "images", Role::kImage, &measureImage<ros::Image>),
      measured("sensor_msgs/CompressedImage", "images", Role::kImage,
               &measureImage<ros::CompressedImage>),
      noted("sensor_msgs/CameraInfo", "camera", &noteCamera),
      observed("sensor_msgs/NavSatFix", "GPS", &observeFix),
      observed("novatel_gps_msgs/NovatelPosition", "GPS, by its fields", &observeFixByFields),
      observed("novatel_gps_msgs/Inspva", "GPS, by its fields", &observeFixByFields),
      observed("novatel_oem7_msgs/BESTPOS", "GPS, by its fields", &observeFixByFields),
      observed("novatel_oem7_msgs/INSPVA", "GPS, by its fields", &observeFixByFields),
      observed("oxts_msgs/Ncom", "GPS with velocity and heading, from packets", &observeNcom),
      observed("sensor_msgs/Imu", "inertial unit", &observeImu),
      observed("geometry_msgs/TwistStamped", "speed, if it is in the vehicle's frame",
               &observeSpeed),
      observed("geometry_msgs/TwistWithCovarianceStamped", "speed, if it is in the vehicle's frame",
               &observeSpeed),
      noted("nav_msgs/Odometry", "poses", &noteOdometry),
      noted("nav_msgs/Path", "poses, if the INI says so", &notePath),
      noted("geometry_msgs/PoseStamped", "poses", &notePose<ros::PoseStamped>),
      noted("geometry_msgs/PoseWithCovarianceStamped", "poses",
            &notePose<ros::PoseWithCovarianceStamped>),
      noted("tf2_msgs/TFMessage", "frames, poses", &noteTransforms),
      noted("tf/tfMessage", "frames, poses", &noteTransforms),
      noted("std_msgs/String", "metadata of a device, on a topic of that name", &noteText),
      packed("velodyne_msgs/VelodyneScan", kPacketsUse, Role::kCloud, nullptr, &unpackVelodyne,
             {"velodyne"}),
      packed("can_msgs/Frame", "radar scans of an ESR or ARS 408, from its CAN frames",
             Role::kRadar, &noteCan, &unpackCan, {"esr", "ars408"}),
      packed("ros2_socketcan_msgs/FdFrame",
             "radar scans of an ESR, ARS 408 or SRR520, from its CAN frames", Role::kRadar,
             &noteCanFd, &unpackCanFd, {"esr", "ars408", "srr520"}),
      packed("delphi_esr_msgs/EsrTrack", "radar scans, by its fields", Role::kRadar, nullptr,
             &unpackEsrTrack, {"esr"}),
  };
  for (const char* name :
       {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg", "livox_interfaces/CustomMsg"})
    types.push_back(measured(name, "lidar scans", Role::kCloud, &measureLivox));
  for (const char* name :
       {"pandar_msgs/PandarScan", "hesai_lidar/PandarScan", "hesai_ros_driver/UdpFrame"})
    types.push_back(
        packed(name, kPacketsUse, Role::kCloud, nullptr, &unpackPandar, {"pandar40p", "xt32"}));
  for (const char* name :
       {"ouster_ros/PacketMsg", "ouster_msgs/PacketMsg", "ouster_sensor_msgs/PacketMsg"})
    types.push_back(
        packed(name, kPacketsUse, Role::kCloud, &noteOuster, &unpackOuster, {"ouster"}));
  for (const char* name :
       {"rslidar_msgs/rslidarScan", "rslidar_msgs/RslidarScan", "rslidar_msg/RslidarScan"})
    types.push_back(
        packed(name, kPacketsUse, Role::kCloud, nullptr, &unpackRslidarScan, robosense));
  for (const char* name :
       {"rslidar_msgs/rslidarPacket", "rslidar_msgs/RslidarPacket", "rslidar_msg/RslidarPacket"})
    types.push_back(
        packed(name, kPacketsUse, Role::kCloud, &noteRslidar, &unpackRslidarPacket, robosense));
  for (const char* name :
       {"autoware_perception_msgs/DetectedObjects", "autoware_perception_msgs/TrackedObjects",
        "autoware_auto_perception_msgs/DetectedObjects",
        "autoware_auto_perception_msgs/TrackedObjects"})
    types.push_back(measured(name, kBoxesUse, Role::kBoxes, &measureAutoware));
  // Each of the transforms has its own; texts and Ouster's packets have none, nor have some of
  // RoboSense's; a camera's is of no matter, nor that of a path, whose poses have theirs.
  for (BagType& type : types) {
    for (const auto note :
         {&noteTransforms, &noteText, &noteOuster, &noteRslidar, &noteCamera, &notePath})
      if (type.note == note) type.has_header = false;
    if (type.note == &noteOuster) type.device_files = &BagContents::metadata;
    if (type.devices == robosense) type.device_files = &BagContents::difop;
  }
  return types;
}

/// The row of a kind of messages that are known by their fields alone.
const BagType* rowByFields(FieldsKind kind) {
  static const BagType cloud = measured("", "lidar or radar scans, by its fields", Role::kCloud,
                                        &measureCloudByFields),
                       image = measured("", "images, by its fields", Role::kImage,
                                        &measureImageByFields),
                       pose =
                           noted("", "poses, by its fields, if the INI says so", &notePoseByFields);
  switch (kind) {
    case FieldsKind::kCloud:
      return &cloud;
    case FieldsKind::kImage:
      return &image;
    case FieldsKind::kPose:
      return &pose;
    default:
      return nullptr;
  }
}

bool isNamed(const BagType& row, const std::string& type) {
  const std::string_view name = row.name;
  if (name.back() != '*') return type == name;
  return type.compare(0, name.size() - 1, name.substr(0, name.size() - 1)) == 0;
}

}  // namespace

const std::vector<BagType>& bagTypes() {
  static const std::vector<BagType> types = makeTypes();
  return types;
}

void addPoseOf(const BagMessage& m, BagContents& contents, const ros::Header& header,
               const ros::Pose& pose, const std::string& frame) {
  BagContents::Poses& to = contents.poses[m.topic->name];
  addPose(to, header, pose, frame);
  to.messages.push_back(static_cast<std::uint32_t>(contents.topics[m.topic->name].messages - 1));
}

void setCloud(const ros::PointCloud2& cloud, const BagTopicParams& params, SensorFrame& frame) {
  using Kind = BagTopicParams::Kind;
  if (params.kind == Kind::kRadar || (params.kind == Kind::kAuto && ros::isOfRadar(cloud)))
    frame.data = ros::returnsOf(cloud, params.rate_scale);
  else
    frame.data = ros::cloudOf(cloud, params.intensity_max);
}

void setImage(Raster&& raster, SensorFrame& frame) {
  CameraImage image;
  image.camera.width = raster.width;
  image.camera.height = raster.height;
  image.load = [raster = std::move(raster)] { return raster; };
  frame.data = std::move(image);
}

std::string frameName(const std::string& name) {
  return !name.empty() && name[0] == '/' ? name.substr(1) : name;
}

const BagType* bagType(const BagTopic& topic) {
  if (!topic.unknown_encoding.empty()) return nullptr;
  const auto& types = bagTypes();
  const auto found = std::find_if(types.begin(), types.end(),
                                  [&](const BagType& row) { return isNamed(row, topic.type); });
  return found == types.end() ? rowByFields(kindByFields(topic)) : &*found;
}

}  // namespace perception
