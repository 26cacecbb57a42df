#include "libperception/importers/BagContents.h"

#include <fmt/format.h>

#include <algorithm>

#include "libperception/core/Error.h"

namespace perception {
namespace {

using ros::decoded;

constexpr const char* kPoseDoc = "x, y, z [m], yaw, pitch, roll [deg] on the vehicle";

bool ends(const std::string& text, const std::string& with) {
  return text.size() >= with.size() &&
         text.compare(text.size() - with.size(), with.size(), with) == 0;
}

// tf of ROS 1 wrote frames with a slash before.
std::string frameName(const std::string& name) {
  return !name.empty() && name[0] == '/' ? name.substr(1) : name;
}

void addPose(BagContents::Poses& to, const ros::Header& header, const ros::Pose& pose,
             const std::string& frame) {
  to.frame = frameName(frame);
  to.poses.push_back({header.stamp, poseOf(pose)});
}

/// Takes what is needed before the sensors' data.
void take(const BagMessage& m, BagContents& contents) {
  const std::string& type = m.topic->type;
  const auto encoding = m.topic->encoding;
  if (type == "tf2_msgs/TFMessage" || type == "tf/tfMessage") {
    for (const auto& t : decoded<ros::TFMessage>(m.bytes, encoding).transforms)
      contents.tree.add(frameName(t.header.frame_id), frameName(t.child_frame_id), t.header.stamp,
                        poseOf(t.transform), ends(m.topic->name, "tf_static"));
  } else if (type == "nav_msgs/Odometry") {
    const auto odometry = decoded<ros::Odometry>(m.bytes, encoding);
    addPose(contents.poses[m.topic->name], odometry.header, odometry.pose, odometry.child_frame_id);
  } else if (type == "geometry_msgs/PoseStamped") {
    const auto pose = decoded<ros::PoseStamped>(m.bytes, encoding);
    addPose(contents.poses[m.topic->name], pose.header, pose.pose, "");
  } else if (type == "sensor_msgs/CameraInfo" && contents.cameras.count(m.topic->name) == 0) {
    contents.cameras[m.topic->name] = decoded<ros::CameraInfo>(m.bytes, encoding);
  }
}

}  // namespace

void BagParams::visit(ParamVisitor& v) {
  v.text("base_frame", base_frame,
         "frame of the vehicle; empty: base_footprint, base_link, ego, or the one that moves");
  v.reals("base_pose", base_pose, -1, {-1000, 1000}, "", kPoseDoc);
  v.require(base_pose.empty() || base_pose.size() == 6, "base_pose: expected six numbers");
  v.text("poses", poses, "the vehicle's poses: tf, a topic, or none; empty: the first there is");
}

void BagTopicParams::visit(ParamVisitor& v) {
  v.text("label", label, "sensor label in the log; empty: the topic's name");
  v.reals("pose", pose, -1, {-1000, 1000}, "", kPoseDoc);
  v.require(pose.empty() || pose.size() == 6, "pose: expected six numbers");
  v.real("intensity_max", intensity_max, {0, 1e9}, "",
         "intensities are divided by it; 0: bytes by 255, others not");
  v.choiceOf("kind", kind, {"auto", "lidar", "radar"},
             "of what clouds are; auto: of a radar, if they have range rates and no beam numbers");
  v.real("rate_scale", rate_scale, {-1, 1}, "",
         "range rates of a radar are multiplied by it: -1 if they are positive where objects come "
         "nearer, 0 if they are none");
  v.boolean("use", use, "no: left out");
}

Pose3 poseOfNumbers(const std::vector<double>& p) {
  return makePose(p[0], p[1], p[2], radians(p[3]), radians(p[4]), radians(p[5]));
}

BagContents readContents(const std::vector<std::string>& files,
                         const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  BagContents contents;
  std::map<std::string, std::pair<std::uint64_t, std::string>> bad;  // by topic: messages, first
  for (const std::string& file : files) {
    const auto bag = openBag(file);
    BagMessage message;
    while (bag->next(message)) {
      BagContents::Row& row = contents.topics[message.topic->name];
      if (row.messages++ == 0) row.topic = *message.topic, row.first = message.stamp;
      row.first = std::min(row.first, message.stamp);
      row.last = std::max(row.last, message.stamp);
      try {
        if (message.topic->unknown_encoding.empty()) take(message, contents);
      } catch (const std::runtime_error& e) {
        if (dynamic_cast<const Error*>(&e) != nullptr) throw;
        auto& [count, first] = bad[message.topic->name];
        if (count++ == 0) first = fmt::format("{}: byte {}: {}", file, message.offset, e.what());
      }
      progress(bag->bytesRead(), bag->fileBytes());
    }
    contents.faults.insert(contents.faults.end(), bag->faults().begin(), bag->faults().end());
  }
  for (const auto& [topic, fault] : bad)
    contents.faults.push_back(fmt::format("{}: {} unreadable messages left out, the first: {}",
                                          topic, fault.first, fault.second));
  for (auto& [topic, poses] : contents.poses)
    std::stable_sort(poses.poses.begin(), poses.poses.end(),
                     [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  return contents;
}

std::string useOfType(const std::string& type) {
  static const std::map<std::string, std::string> uses = {
      {"sensor_msgs/PointCloud2", "lidar or radar scans"},
      {"radar_msgs/RadarScan", "radar scans"},
      {"vision_msgs/Detection3DArray", "boxes, if the INI has [topic.TOPIC]"},
      {"sensor_msgs/Image", "images"},
      {"sensor_msgs/CompressedImage", "images"},
      {"sensor_msgs/CameraInfo", "camera"},
      {"sensor_msgs/NavSatFix", "GPS"},
      {"sensor_msgs/Imu", "inertial unit"},
      {"nav_msgs/Odometry", "poses"},
      {"geometry_msgs/PoseStamped", "poses"},
      {"tf2_msgs/TFMessage", "frames, poses"},
      {"tf/tfMessage", "frames, poses"}};
  const auto found = uses.find(type);
  return found == uses.end() ? "" : found->second;
}

std::string listOf(const BagContents& contents) {
  std::string text =
      fmt::format("{:<36} {:<30} {:>8} {:>8}  {}\n", "topic", "type", "messages", "Hz", "read as");
  for (const auto& [name, row] : contents.topics) {
    const double seconds = row.last - row.first;
    const std::string rate =
        seconds > 0 ? fmt::format("{:.2f}", static_cast<double>(row.messages - 1) / seconds) : "";
    const std::string use = row.topic.unknown_encoding.empty()
                                ? useOfType(row.topic.type)
                                : "not: encoding " + row.topic.unknown_encoding;
    text += fmt::format("{:<36} {:<30} {:>8} {:>8}  {}\n", name, row.topic.type, row.messages, rate,
                        use.empty() ? "not" : use);
  }
  return text;
}

}  // namespace perception
