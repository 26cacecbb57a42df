#include "libperception/importers/messages/BagTypes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
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

template <class Message>
ros::Header measureScan(const BagMessage& m, const BagTopicParams& params, SensorFrame& frame) {
  const auto scan = messageIn<Message>(m);
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

// Rows by what they have; add() gives them their names.

using Note = decltype(BagType::note);

BagType measured(const char* use, Role role, decltype(BagType::measure) measure) {
  return {"", use, role, measure};
}
BagType noted(const char* use, Note note, bool has_header = true) {
  BagType type{"", use, Role::kOther, nullptr, note};
  type.has_header = has_header;
  return type;
}
BagType observed(const char* use, decltype(BagType::observe) observe) {
  BagType type{"", use};
  type.observe = observe;
  type.of_vehicle = observe == &observeSpeed;
  return type;
}
BagType packed(const char* use, Role role, Note note, decltype(BagType::unpack) unpack,
               std::vector<const char*> devices) {
  BagType type{"", use, role, nullptr, note, unpack, std::move(devices)};
  type.may_be_silent = note != nullptr;
  return type;
}

constexpr const char* kBoxesUse = "boxes, if the INI has [topic.TOPIC]";
constexpr const char* kPacketsUse = "lidar scans, from packets";

/// The same row for several names.
void add(std::vector<BagType>& types, std::initializer_list<const char*> names, BagType row) {
  for (const char* name : names) {
    row.name = name;
    types.push_back(row);
  }
}

/// What sensors measure. A camera's header is of no matter.
void addMeasurements(std::vector<BagType>& types) {
  add(types, {"sensor_msgs/PointCloud2"},
      measured("lidar or radar scans", Role::kCloud, &measurePoints));
  add(types, {"sensor_msgs/PointCloud"},
      measured("lidar or radar scans", Role::kCloud, &measureOldCloud));
  add(types,
      {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg", "livox_interfaces/CustomMsg"},
      measured("lidar scans", Role::kCloud, &measureScan<ros::LivoxScan>));
  add(types, {"sensor_msgs/LaserScan"},
      measured("lidar scans of one layer", Role::kCloud, &measureScan<ros::LaserScan>));
  add(types, {"radar_msgs/RadarScan"},
      measured("radar scans", Role::kRadar, &measureRadar<ros::RadarScan>));
  add(types, {"radar_msgs/RadarTracks"},
      measured("radar scans: a return an object", Role::kRadar, &measureRadar<ros::RadarTracks>));
  add(types, {"ars_40X/*", "conti_radar/*"},
      measured("radar scans: a return an object or cluster, by its fields", Role::kRadar,
               &measureRadarList));
  add(types, {"vision_msgs/Detection3DArray"}, measured(kBoxesUse, Role::kBoxes, &measureBoxes));
  add(types, {"vision_msgs/Detection2DArray"},
      measured("boxes in images, if the INI has [topic.TOPIC]", Role::kBoxes, &measureImageBoxes));
  add(types, {"derived_object_msgs/ObjectArray", "derived_object_msgs/ObjectWithCovarianceArray"},
      measured(kBoxesUse, Role::kBoxes, &measureDerivedObjects));
  add(types,
      {"autoware_perception_msgs/DetectedObjects", "autoware_perception_msgs/TrackedObjects",
       "autoware_auto_perception_msgs/DetectedObjects",
       "autoware_auto_perception_msgs/TrackedObjects"},
      measured(kBoxesUse, Role::kBoxes, &measureAutoware));
  add(types, {"sensor_msgs/Image"}, measured("images", Role::kImage, &measureImage<ros::Image>));
  add(types, {"sensor_msgs/CompressedImage"},
      measured("images", Role::kImage, &measureImage<ros::CompressedImage>));
  add(types, {"sensor_msgs/CameraInfo"}, noted("camera", &noteCamera, false));
}

/// Where the vehicle is and how it moves, frames, and texts. Each of the transforms has a header of
/// its own, texts have none; that of a path is of no matter, whose poses have theirs.
void addVehicle(std::vector<BagType>& types) {
  add(types, {"sensor_msgs/NavSatFix"}, observed("GPS", &observeFix));
  add(types,
      {"novatel_gps_msgs/NovatelPosition", "novatel_gps_msgs/Inspva", "novatel_oem7_msgs/BESTPOS",
       "novatel_oem7_msgs/INSPVA"},
      observed("GPS, by its fields", &observeFixByFields));
  add(types, {"oxts_msgs/Ncom"},
      observed("GPS with velocity and heading, from packets", &observeNcom));
  add(types, {"sensor_msgs/Imu"}, observed("inertial unit", &observeImu));
  add(types, {"geometry_msgs/TwistStamped", "geometry_msgs/TwistWithCovarianceStamped"},
      observed("speed, if it is in the vehicle's frame", &observeSpeed));
  add(types, {"nav_msgs/Odometry"}, noted("poses", &noteOdometry));
  add(types, {"nav_msgs/Path"}, noted("poses, if the INI says so", &notePath, false));
  add(types, {"geometry_msgs/PoseStamped"}, noted("poses", &notePose<ros::PoseStamped>));
  add(types, {"geometry_msgs/PoseWithCovarianceStamped"},
      noted("poses", &notePose<ros::PoseWithCovarianceStamped>));
  add(types, {"tf2_msgs/TFMessage", "tf/tfMessage"},
      noted("frames, poses", &noteTransforms, false));
  add(types, {"std_msgs/String"},
      noted("metadata of a device, on a topic of that name", &noteText, false));
}

/// Packets of sensors. Those of Ouster have no header, nor have some of RoboSense.
void addPackets(std::vector<BagType>& types) {
  add(types, {"velodyne_msgs/VelodyneScan"},
      packed(kPacketsUse, Role::kCloud, nullptr, &unpackVelodyne, {"velodyne"}));
  add(types, {"pandar_msgs/PandarScan", "hesai_lidar/PandarScan", "hesai_ros_driver/UdpFrame"},
      packed(kPacketsUse, Role::kCloud, nullptr, &unpackPandar, {"pandar40p", "xt32"}));
  BagType ouster = packed(kPacketsUse, Role::kCloud, &noteOuster, &unpackOuster, {"ouster"});
  ouster.device_files = &BagContents::metadata, ouster.has_header = false;
  add(types, {"ouster_ros/PacketMsg", "ouster_msgs/PacketMsg", "ouster_sensor_msgs/PacketMsg"},
      ouster);
  const std::vector<const char*> robosense = {"rs16", "rs32", "helios32", "helios16", "bpearl"};
  BagType scan = packed(kPacketsUse, Role::kCloud, nullptr, &unpackRslidarScan, robosense);
  BagType packet = packed(kPacketsUse, Role::kCloud, &noteRslidar, &unpackRslidarPacket, robosense);
  scan.device_files = packet.device_files = &BagContents::difop, packet.has_header = false;
  add(types, {"rslidar_msgs/rslidarScan", "rslidar_msgs/RslidarScan", "rslidar_msg/RslidarScan"},
      scan);
  add(types,
      {"rslidar_msgs/rslidarPacket", "rslidar_msgs/RslidarPacket", "rslidar_msg/RslidarPacket"},
      packet);
  add(types, {"can_msgs/Frame"},
      packed("radar scans of an ESR or ARS 408, from its CAN frames", Role::kRadar, &noteCan,
             &unpackCan, {"esr", "ars408"}));
  add(types, {"ros2_socketcan_msgs/FdFrame"},
      packed("radar scans of an ESR, ARS 408 or SRR520, from its CAN frames", Role::kRadar,
             &noteCanFd, &unpackCanFd, {"esr", "ars408", "srr520"}));
  add(types, {"delphi_esr_msgs/EsrTrack"},
      packed("radar scans, by its fields", Role::kRadar, nullptr, &unpackEsrTrack, {"esr"}));
}

/// The row of a kind of messages that are known by their fields alone.
const BagType* rowByFields(FieldsKind kind) {
  static const BagType cloud = measured("lidar or radar scans, by its fields", Role::kCloud,
                                        &measureCloudByFields),
                       image =
                           measured("images, by its fields", Role::kImage, &measureImageByFields),
                       pose = noted("poses, by its fields, if the INI says so", &notePoseByFields);
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
  static const std::vector<BagType> types = [] {
    std::vector<BagType> all;
    addMeasurements(all), addVehicle(all), addPackets(all);
    return all;
  }();
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
