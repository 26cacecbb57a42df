#include "libperception/importers/BagTypes.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "libperception/interop/RosDevices.h"
#include "libperception/interop/RosScene.h"
#include "libperception/interop/RosSensors.h"
#include "libperception/packets/CanBundle.h"

namespace perception {
namespace {

using ros::decoded;
using Role = BagType::Role;

void addPose(BagContents::Poses& to, const ros::Header& header, const ros::Pose& pose,
             const std::string& frame) {
  to.frame = frameName(frame);
  to.poses.push_back({header.stamp, poseOf(pose)});
}

/// That of a message: its place among those of the topic tells whether it is used.
void addPoseOf(const BagMessage& m, BagContents& contents, const ros::Header& header,
               const ros::Pose& pose, const std::string& frame) {
  BagContents::Poses& to = contents.poses[m.topic->name];
  addPose(to, header, pose, frame);
  to.messages.push_back(contents.topics[m.topic->name].messages - 1);
}

template <class Message>
Message messageIn(const BagMessage& m) {
  return decoded<Message>(m.bytes, m.topic->encoding);
}

void noteTransforms(const BagMessage& m, BagContents& contents) {
  constexpr std::string_view kFixed = "tf_static";
  const std::string& topic = m.topic->name;
  const bool fixed = topic.size() >= kFixed.size() &&
                     topic.compare(topic.size() - kFixed.size(), kFixed.size(), kFixed) == 0;
  for (const auto& t : messageIn<ros::TFMessage>(m).transforms)
    contents.transforms[frameName(t.child_frame_id)].push_back(
        {frameName(t.header.frame_id), {t.header.stamp, m.stamp}, poseOf(t.transform), fixed});
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
  BagContents::Poses poses;
  for (const auto& pose : path.poses) addPose(poses, pose.header, pose.pose, "");
  BagContents::Poses& known = contents.poses[m.topic->name];
  known.on_call = true;
  // One that was cut at its beginning adds what is new.
  for (const StampedPose& pose : poses.poses) {
    if (known.poses.empty() || known.poses.back().stamp < pose.stamp) known.poses.push_back(pose);
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
  using Kind = BagTopicParams::Kind;
  if (params.kind == Kind::kRadar || (params.kind == Kind::kAuto && ros::isOfRadar(cloud)))
    frame.data = ros::returnsOf(cloud, params.rate_scale);
  else
    frame.data = ros::cloudOf(cloud, params.intensity_max);
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
  Raster raster = ros::rasterOf(message);
  CameraImage image;
  image.camera.width = raster.width;
  image.camera.height = raster.height;
  image.load = [raster = std::move(raster)] { return raster; };
  frame.data = std::move(image);
  return message.header;
}

ros::Header unpackVelodyne(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto scan = messageIn<ros::VelodyneScan>(m);
  for (const auto& packet : scan.packets)
    packets.push_back({std::string(packet.data.bytes), packet.stamp});
  return scan.header;
}

ros::Header unpackPandar(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto scan = messageIn<ros::PandarScan>(m);
  for (const auto& packet : scan.packets) {
    if (packet.size > packet.data.bytes.size())
      throw std::runtime_error(fmt::format("a packet of {} bytes, expected at most {}", packet.size,
                                           packet.data.bytes.size()));
    packets.push_back({std::string(packet.data.bytes.substr(0, packet.size)), packet.stamp});
  }
  return scan.header;
}

/// The inertial unit's packets have the same type; they are short.
bool isOfLidar(const ros::OusterPacket& packet) {
  constexpr std::size_t kLongestOfInertialUnit = 64;
  return packet.bytes.size() > kLongestOfInertialUnit;
}

void noteOuster(const BagMessage& m, BagContents& contents) {
  if (isOfLidar(messageIn<ros::OusterPacket>(m))) contents.lidar_packets.insert(m.topic->name);
}

ros::Header unpackOuster(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto packet = messageIn<ros::OusterPacket>(m);
  if (isOfLidar(packet)) packets.push_back({std::string(packet.bytes), m.stamp});
  return {m.stamp, "os_sensor"};
}

/// A frame of a CAN bus; remote and error frames have no data.
ros::Header unpackCan(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto frame = messageIn<ros::CanFrame>(m);
  if (frame.length > frame.data.bytes.size())
    throw std::runtime_error(fmt::format("a CAN frame of {} bytes, expected at most {}",
                                         frame.length, frame.data.bytes.size()));
  if (frame.is_rtr == 0 && frame.is_error == 0)
    packets.push_back(
        {canMessage(frame.id, frame.data.bytes.substr(0, frame.length)), frame.header.stamp});
  return frame.header;
}

std::vector<BagType> makeTypes() {
  constexpr const char* kBoxesUse = "boxes, if the INI has [topic.TOPIC]";
  std::vector<BagType> types = {
      {"sensor_msgs/PointCloud2", "lidar or radar scans", Role::kCloud, &measurePoints},
      {"radar_msgs/RadarScan", "radar scans", Role::kRadar, &measureRadar<ros::RadarScan>},
      {"radar_msgs/RadarTracks", "radar scans: a return an object", Role::kRadar,
       &measureRadar<ros::RadarTracks>},
      {"vision_msgs/Detection3DArray", kBoxesUse, Role::kBoxes, &measureBoxes},
      {"sensor_msgs/Image", "images", Role::kImage, &measureImage<ros::Image>},
      {"sensor_msgs/CompressedImage", "images", Role::kImage, &measureImage<ros::CompressedImage>},
      {"sensor_msgs/CameraInfo", "camera", Role::kOther, nullptr, &noteCamera},
      {"sensor_msgs/NavSatFix", "GPS"},
      {"sensor_msgs/Imu", "inertial unit"},
      {"nav_msgs/Odometry", "poses", Role::kOther, nullptr, &noteOdometry},
      {"nav_msgs/Path", "poses, if the INI says so", Role::kOther, nullptr, &notePath},
      {"geometry_msgs/PoseStamped", "poses", Role::kOther, nullptr, &notePose<ros::PoseStamped>},
      {"geometry_msgs/PoseWithCovarianceStamped", "poses", Role::kOther, nullptr,
       &notePose<ros::PoseWithCovarianceStamped>},
      {"tf2_msgs/TFMessage", "frames, poses", Role::kOther, nullptr, &noteTransforms},
      {"tf/tfMessage", "frames, poses", Role::kOther, nullptr, &noteTransforms},
      {"std_msgs/String", "metadata of a device, on a topic of that name", Role::kOther, nullptr,
       &noteText},
      {"velodyne_msgs/VelodyneScan",
       "lidar scans, from packets",
       Role::kCloud,
       nullptr,
       nullptr,
       &unpackVelodyne,
       {"velodyne"}},
      {"can_msgs/Frame",
       "radar scans of a Delphi ESR, from its CAN frames",
       Role::kRadar,
       nullptr,
       nullptr,
       &unpackCan,
       {"esr"}},
  };
  for (const char* name :
       {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg", "livox_interfaces/CustomMsg"})
    types.push_back({name, "lidar scans", Role::kCloud, &measureLivox});
  for (const char* name :
       {"pandar_msgs/PandarScan", "hesai_lidar/PandarScan", "hesai_ros_driver/UdpFrame"})
    types.push_back({name,
                     "lidar scans, from packets",
                     Role::kCloud,
                     nullptr,
                     nullptr,
                     &unpackPandar,
                     {"pandar40p", "xt32"}});
  for (const char* name :
       {"ouster_ros/PacketMsg", "ouster_msgs/PacketMsg", "ouster_sensor_msgs/PacketMsg"})
    types.push_back({name,
                     "lidar scans, from packets",
                     Role::kCloud,
                     nullptr,
                     &noteOuster,
                     &unpackOuster,
                     {"ouster"}});
  // Each of the transforms has its own; texts and Ouster's packets have none; a camera's is of no
  // matter, nor that of a path, whose poses have theirs.
  for (BagType& type : types) {
    for (const auto note : {&noteTransforms, &noteText, &noteOuster, &noteCamera, &notePath})
      if (type.note == note) type.has_header = false;
  }
  return types;
}

}  // namespace

const std::vector<BagType>& bagTypes() {
  static const std::vector<BagType> types = makeTypes();
  return types;
}

std::string frameName(const std::string& name) {
  return !name.empty() && name[0] == '/' ? name.substr(1) : name;
}

const BagType* bagType(const std::string& type) {
  const auto& types = bagTypes();
  const auto found = std::find_if(types.begin(), types.end(),
                                  [&](const BagType& row) { return type == row.name; });
  return found == types.end() ? nullptr : &*found;
}

}  // namespace perception
