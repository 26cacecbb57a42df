#include "libperception/interop/RosSchemas.h"

#include <map>
#include <set>
#include <vector>

namespace perception::ros {
namespace {

struct Member {
  const char* type;  ///< with a package: of another message
  const char* name;
};

const std::map<std::string, std::vector<Member>> kMessages = {
    {"builtin_interfaces/Time", {{"int32", "sec"}, {"uint32", "nanosec"}}},
    {"std_msgs/Header", {{"builtin_interfaces/Time", "stamp"}, {"string", "frame_id"}}},
    {"geometry_msgs/Vector3", {{"float64", "x"}, {"float64", "y"}, {"float64", "z"}}},
    {"geometry_msgs/Point", {{"float64", "x"}, {"float64", "y"}, {"float64", "z"}}},
    {"geometry_msgs/Quaternion",
     {{"float64", "x"}, {"float64", "y"}, {"float64", "z"}, {"float64", "w"}}},
    {"geometry_msgs/Pose",
     {{"geometry_msgs/Point", "position"}, {"geometry_msgs/Quaternion", "orientation"}}},
    {"geometry_msgs/PoseWithCovariance",
     {{"geometry_msgs/Pose", "pose"}, {"float64[36]", "covariance"}}},
    {"geometry_msgs/Transform",
     {{"geometry_msgs/Vector3", "translation"}, {"geometry_msgs/Quaternion", "rotation"}}},
    {"geometry_msgs/TransformStamped",
     {{"std_msgs/Header", "header"},
      {"string", "child_frame_id"},
      {"geometry_msgs/Transform", "transform"}}},
    {"tf2_msgs/TFMessage", {{"geometry_msgs/TransformStamped[]", "transforms"}}},
    {"sensor_msgs/PointField",
     {{"string", "name"}, {"uint32", "offset"}, {"uint8", "datatype"}, {"uint32", "count"}}},
    {"sensor_msgs/PointCloud2",
     {{"std_msgs/Header", "header"},
      {"uint32", "height"},
      {"uint32", "width"},
      {"sensor_msgs/PointField[]", "fields"},
      {"bool", "is_bigendian"},
      {"uint32", "point_step"},
      {"uint32", "row_step"},
      {"uint8[]", "data"},
      {"bool", "is_dense"}}},
    {"radar_msgs/RadarReturn",
     {{"float32", "range"},
      {"float32", "azimuth"},
      {"float32", "elevation"},
      {"float32", "doppler_velocity"},
      {"float32", "amplitude"}}},
    {"radar_msgs/RadarScan",
     {{"std_msgs/Header", "header"}, {"radar_msgs/RadarReturn[]", "returns"}}},
    {"sensor_msgs/CompressedImage",
     {{"std_msgs/Header", "header"}, {"string", "format"}, {"uint8[]", "data"}}},
    {"sensor_msgs/RegionOfInterest",
     {{"uint32", "x_offset"},
      {"uint32", "y_offset"},
      {"uint32", "height"},
      {"uint32", "width"},
      {"bool", "do_rectify"}}},
    {"sensor_msgs/CameraInfo",
     {{"std_msgs/Header", "header"},
      {"uint32", "height"},
      {"uint32", "width"},
      {"string", "distortion_model"},
      {"float64[]", "d"},
      {"float64[9]", "k"},
      {"float64[9]", "r"},
      {"float64[12]", "p"},
      {"uint32", "binning_x"},
      {"uint32", "binning_y"},
      {"sensor_msgs/RegionOfInterest", "roi"}}},
    {"vision_msgs/ObjectHypothesis", {{"string", "class_id"}, {"float64", "score"}}},
    {"vision_msgs/ObjectHypothesisWithPose",
     {{"vision_msgs/ObjectHypothesis", "hypothesis"},
      {"geometry_msgs/PoseWithCovariance", "pose"}}},
    {"vision_msgs/BoundingBox3D",
     {{"geometry_msgs/Pose", "center"}, {"geometry_msgs/Vector3", "size"}}},
    {"vision_msgs/Detection3D",
     {{"std_msgs/Header", "header"},
      {"vision_msgs/ObjectHypothesisWithPose[]", "results"},
      {"vision_msgs/BoundingBox3D", "bbox"},
      {"string", "id"}}},
    {"vision_msgs/Detection3DArray",
     {{"std_msgs/Header", "header"}, {"vision_msgs/Detection3D[]", "detections"}}}};

/// Adds the types within a message, each once, in the order of first use.
void addWithin(const std::string& type, std::set<std::string>& known,
               std::vector<std::string>& order) {
  for (const Member& member : kMessages.at(type)) {
    const std::string name = std::string(member.type).substr(0, std::string(member.type).find('['));
    if (name.find('/') == std::string::npos || !known.insert(name).second) continue;
    order.push_back(name);
    addWithin(name, known, order);
  }
}

std::string membersOf(const std::string& type) {
  std::string text;
  for (const Member& member : kMessages.at(type))
    text += std::string(member.type) + " " + member.name + "\n";
  return text;
}

}  // namespace

McapWriter::Schema schemaOf(const std::string& type) {
  std::set<std::string> known;
  std::vector<std::string> within;
  addWithin(type, known, within);
  std::string text = membersOf(type);
  for (const std::string& name : within)
    text += std::string(80, '=') + "\nMSG: " + name + "\n" + membersOf(name);
  const auto slash = type.find('/');
  return {type.substr(0, slash) + "/msg" + type.substr(slash), "ros2msg", text};
}

}  // namespace perception::ros
