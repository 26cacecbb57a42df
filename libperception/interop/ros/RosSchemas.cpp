#include "libperception/interop/ros/RosSchemas.h"

#include <map>
#include <set>
#include <vector>

namespace perception::ros {
namespace {

struct Member {
  const char* type;  ///< with a package: of another message
  const char* name;
};

std::vector<Member> derivedObject(const char* shape) {
  return {{"std_msgs/Header", "header"},
          {"uint32", "id"},
          {"uint8", "detection_level"},
          {"bool", "object_classified"},
          {"geometry_msgs/Pose", "pose"},
          {"geometry_msgs/Twist", "twist"},
          {"geometry_msgs/Accel", "accel"},
          {"geometry_msgs/Polygon", "polygon"},
          {shape, "shape"},
          {"uint8", "classification"},
          {"uint8", "classification_certainty"},
          {"uint32", "classification_age"}};
}

/// A "~" behind a name: another layout of the same message.
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
    {"geometry_msgs/Point32", {{"float32", "x"}, {"float32", "y"}, {"float32", "z"}}},
    {"geometry_msgs/Polygon", {{"geometry_msgs/Point32[]", "points"}}},
    {"geometry_msgs/Pose2D", {{"float64", "x"}, {"float64", "y"}, {"float64", "theta"}}},
    {"geometry_msgs/Twist",
     {{"geometry_msgs/Vector3", "linear"}, {"geometry_msgs/Vector3", "angular"}}},
    {"geometry_msgs/TwistWithCovariance",
     {{"geometry_msgs/Twist", "twist"}, {"float64[36]", "covariance"}}},
    {"geometry_msgs/TwistStamped",
     {{"std_msgs/Header", "header"}, {"geometry_msgs/Twist", "twist"}}},
    {"geometry_msgs/TwistWithCovarianceStamped",
     {{"std_msgs/Header", "header"}, {"geometry_msgs/TwistWithCovariance", "twist"}}},
    {"geometry_msgs/Accel",
     {{"geometry_msgs/Vector3", "linear"}, {"geometry_msgs/Vector3", "angular"}}},
    {"geometry_msgs/AccelWithCovariance",
     {{"geometry_msgs/Accel", "accel"}, {"float64[36]", "covariance"}}},
    {"sensor_msgs/ChannelFloat32", {{"string", "name"}, {"float32[]", "values"}}},
    {"sensor_msgs/PointCloud",
     {{"std_msgs/Header", "header"},
      {"geometry_msgs/Point32[]", "points"},
      {"sensor_msgs/ChannelFloat32[]", "channels"}}},
    {"sensor_msgs/Image",
     {{"std_msgs/Header", "header"},
      {"uint32", "height"},
      {"uint32", "width"},
      {"string", "encoding"},
      {"uint8", "is_bigendian"},
      {"uint32", "step"},
      {"uint8[]", "data"}}},
    {"vision_msgs/BoundingBox2D",
     {{"geometry_msgs/Pose2D", "center"}, {"float64", "size_x"}, {"float64", "size_y"}}},
    {"vision_msgs/Detection2D",
     {{"std_msgs/Header", "header"},
      {"vision_msgs/ObjectHypothesisWithPose[]", "results"},
      {"vision_msgs/BoundingBox2D", "bbox"},
      {"string", "id"}}},
    {"vision_msgs/Detection2DArray",
     {{"std_msgs/Header", "header"}, {"vision_msgs/Detection2D[]", "detections"}}},
    // Until ROS 2 Foxy.
    {"vision_msgs/Detection2D~",
     {{"std_msgs/Header", "header"},
      {"vision_msgs/ObjectHypothesisWithPose[]", "results"},
      {"vision_msgs/BoundingBox2D", "bbox"},
      {"sensor_msgs/Image", "source_img"},
      {"bool", "is_tracking"},
      {"string", "tracking_id"}}},
    {"vision_msgs/Detection2DArray~",
     {{"std_msgs/Header", "header"}, {"vision_msgs/Detection2D~[]", "detections"}}},
    {"oxts_msgs/Ncom", {{"std_msgs/Header", "header"}, {"uint8[]", "raw_packet"}}},
    {"unique_identifier_msgs/UUID", {{"uint8[16]", "uuid"}}},
    {"autoware_perception_msgs/ObjectClassification",
     {{"uint8", "label"}, {"float32", "probability"}}},
    {"autoware_perception_msgs/Shape",
     {{"uint8", "type"},
      {"geometry_msgs/Polygon", "footprint"},
      {"geometry_msgs/Vector3", "dimensions"}}},
    {"autoware_perception_msgs/DetectedObjectKinematics",
     {{"geometry_msgs/PoseWithCovariance", "pose_with_covariance"},
      {"bool", "has_position_covariance"},
      {"uint8", "orientation_availability"},
      {"geometry_msgs/TwistWithCovariance", "twist_with_covariance"},
      {"bool", "has_twist"},
      {"bool", "has_twist_covariance"}}},
    {"autoware_perception_msgs/DetectedObject",
     {{"float32", "existence_probability"},
      {"autoware_perception_msgs/ObjectClassification[]", "classification"},
      {"autoware_perception_msgs/DetectedObjectKinematics", "kinematics"},
      {"autoware_perception_msgs/Shape", "shape"}}},
    {"autoware_perception_msgs/DetectedObjects",
     {{"std_msgs/Header", "header"}, {"autoware_perception_msgs/DetectedObject[]", "objects"}}},
    {"autoware_perception_msgs/TrackedObjectKinematics",
     {{"geometry_msgs/PoseWithCovariance", "pose_with_covariance"},
      {"uint8", "orientation_availability"},
      {"geometry_msgs/TwistWithCovariance", "twist_with_covariance"},
      {"geometry_msgs/AccelWithCovariance", "acceleration_with_covariance"},
      {"bool", "is_stationary"}}},
    {"autoware_perception_msgs/TrackedObject",
     {{"unique_identifier_msgs/UUID", "object_id"},
      {"float32", "existence_probability"},
      {"autoware_perception_msgs/ObjectClassification[]", "classification"},
      {"autoware_perception_msgs/TrackedObjectKinematics", "kinematics"},
      {"autoware_perception_msgs/Shape", "shape"}}},
    {"autoware_perception_msgs/TrackedObjects",
     {{"std_msgs/Header", "header"}, {"autoware_perception_msgs/TrackedObject[]", "objects"}}},
    {"shape_msgs/SolidPrimitive", {{"uint8", "type"}, {"float64[]", "dimensions"}}},
    // Since ROS 2 Galactic.
    {"shape_msgs/SolidPrimitive~",
     {{"uint8", "type"}, {"float64[]", "dimensions"}, {"geometry_msgs/Polygon", "polygon"}}},
    {"derived_object_msgs/Object", derivedObject("shape_msgs/SolidPrimitive")},
    {"derived_object_msgs/ObjectArray",
     {{"std_msgs/Header", "header"}, {"derived_object_msgs/Object[]", "objects"}}},
    {"derived_object_msgs/Object~", derivedObject("shape_msgs/SolidPrimitive~")},
    {"derived_object_msgs/ObjectArray~",
     {{"std_msgs/Header", "header"}, {"derived_object_msgs/Object~[]", "objects"}}},
    {"ros2_socketcan_msgs/FdFrame",
     {{"std_msgs/Header", "header"},
      {"uint32", "id"},
      {"bool", "is_extended"},
      {"bool", "is_error"},
      {"uint8", "len"},
      {"uint8[<=64]", "data"}}},
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

}  // namespace

std::string membersOfType(const std::string& type) {
  std::string text;
  const auto found = kMessages.find(type);
  if (found == kMessages.end()) return text;
  for (const Member& member : found->second)
    text += std::string(member.type) + " " + member.name + "\n";
  return text;
}

McapWriter::Schema schemaOf(const std::string& type) {
  std::set<std::string> known;
  std::vector<std::string> within;
  addWithin(type, known, within);
  std::string text = membersOfType(type);
  for (const std::string& name : within)
    text += std::string(80, '=') + "\nMSG: " + name + "\n" + membersOfType(name);
  const auto slash = type.find('/');
  return {type.substr(0, slash) + "/msg" + type.substr(slash), "ros2msg", text};
}

}  // namespace perception::ros
