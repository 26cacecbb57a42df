#include <array>
#include <map>

#include "libperception/interop/ExportFile.h"
#include "libperception/interop/Jpeg.h"
#include "libperception/interop/RosMessages.h"
#include "libperception/interop/RosSchemas.h"
#include "libperception/interop/RosSensors.h"

namespace perception {
namespace {

// Frames of ROS's REP 105.
constexpr const char* kWorld = "map";
constexpr const char* kVehicle = "base_link";
// Who comes late still gets what does not change (rosbag2's metadata up to version 8).
constexpr const char* kLatched =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline: {sec: 9223372036, nsec: 854775807}\n"
    "  lifespan: {sec: 9223372036, nsec: 854775807}\n  liveliness: 1\n"
    "  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}\n"
    "  avoid_ros_namespace_conventions: false\n";

/// The object's box; classes with their probability times that of its existence.
ros::Detection3D detectionOf(const SceneObject& object, const ros::Header& header,
                             const std::vector<std::string>& class_names) {
  constexpr double kLeast = 0.01;  // probability of classes that are named
  ros::Detection3D d;
  d.header = header;
  const Pose3 T = makePose(object.position.x(), object.position.y(),
                           object.position.z() + object.height / 2, object.yaw);
  d.center = ros::messageOf(T);
  d.size = {object.length, object.width, object.height};
  d.id = std::to_string(object.id);
  const double variances[] = {object.sd_x, object.sd_y, object.sd_yaw};
  for (std::size_t c = 0; c < object.class_probability.size(); ++c) {
    if (object.class_probability[c] < kLeast) continue;
    ros::ObjectHypothesis h;
    h.class_id = class_names[c];
    h.score = object.class_probability[c] * object.existence;
    h.pose = d.center;
    for (const auto& [at, k] : {std::pair(0, 0), std::pair(7, 1), std::pair(35, 2)})
      h.covariance[static_cast<std::size_t>(at)] = variances[k] * variances[k];
    d.results.push_back(std::move(h));
  }
  return d;
}

/// Frames map, base_link and one a sensor; channels begin with their first message.
class RosFile final : public ExportFile {
 public:
  RosFile(const std::string& path, const std::vector<std::string>& class_names)
      : mcap_(path, "ros2"), class_names_(class_names) {}

  void writePose(Stamp stamp, const Pose3& T_world_ego) override {
    has_poses_ = true;
    transform("/tf", stamp, T_world_ego, kWorld, kVehicle);
  }

  void writeScene(const Scene& scene) override {
    if (!has_poses_) transform("/tf", scene.stamp, scene.ego.T_world_ego, kWorld, kVehicle);
    ros::Detection3DArray array;
    array.header = {scene.stamp, kWorld};
    for (const SceneObject& object : scene.objects)
      array.detections.push_back(detectionOf(object, array.header, class_names_));
    write("/tracks", "vision_msgs/Detection3DArray", scene.stamp, array);
  }

  bool writeFrame(const SensorFrame& frame) override {
    const ros::Header header{frame.stamp, frame.sensor};
    std::string data;
    if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
      place(frame);
      write("/" + frame.sensor, "sensor_msgs/PointCloud2", frame.stamp,
            ros::messageOf(*cloud, header, data));
      return true;
    }
    const auto* image = std::get_if<CameraImage>(&frame.data);
    const auto raster = image && image->load ? image->load() : std::nullopt;
    if (!raster) return false;
    place(frame);
    data = jpegOf(*raster);
    CameraModel camera = image->camera;
    camera.width = raster->width, camera.height = raster->height;
    if (camera.projection == CameraModel::Projection::kPinhole && camera.fx > 0)
      write("/" + frame.sensor + "/camera_info", "sensor_msgs/CameraInfo", frame.stamp,
            ros::messageOf(camera, header));
    write("/" + frame.sensor + "/image", "sensor_msgs/CompressedImage", frame.stamp,
          ros::CompressedImage{header, "jpeg", data});
    return true;
  }

  std::uint64_t close() override {
    mcap_.close();
    return mcap_.messages();
  }

 private:
  /// The sensor's place on the vehicle, whenever it is another one.
  void place(const SensorFrame& frame) {
    const auto [known, is_new] = placed_.try_emplace(frame.sensor, frame.T_ego_sensor);
    if (!is_new && known->second.isApprox(frame.T_ego_sensor, 1e-12)) return;
    known->second = frame.T_ego_sensor;
    transform("/tf_static", frame.stamp, frame.T_ego_sensor, kVehicle, frame.sensor);
  }

  void transform(const char* topic, Stamp stamp, const Pose3& T, const std::string& parent,
                 const std::string& child) {
    const ros::TFMessage message{{{{stamp, parent}, child, ros::messageOf(T)}}};
    write(topic, "tf2_msgs/TFMessage", stamp, message);
  }

  template <class Message>
  void write(const std::string& topic, const std::string& type, Stamp stamp,
             const Message& message) {
    auto known = channels_.find(topic);
    if (known == channels_.end()) {
      const std::string qos = topic == "/tf_static" ? kLatched : "";
      const auto id =
          mcap_.addChannel(topic, "cdr", ros::schemaOf(type), {{"offered_qos_profiles", qos}});
      known = channels_.emplace(topic, id).first;
    }
    mcap_.write(known->second, stamp, ros::encoded(message, ros::Encoding::kCdr));
  }

  McapWriter mcap_;
  const std::vector<std::string> class_names_;
  std::map<std::string, std::uint16_t> channels_;
  std::map<std::string, Pose3> placed_;
  bool has_poses_ = false;
};

}  // namespace

std::unique_ptr<ExportFile> makeRosFile(const std::string& path,
                                        const std::vector<std::string>& class_names) {
  return std::make_unique<RosFile>(path, class_names);
}

}  // namespace perception
