#include <map>
#include <string>

#include "libperception/interop/exports/ExportFile.h"
#include "libperception/interop/exports/Jpeg.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosScene.h"
#include "libperception/interop/ros/RosSchemas.h"
#include "libperception/interop/ros/RosSensors.h"

namespace perception {
namespace {

// Who comes late still gets what does not change (rosbag2's metadata up to version 8).
constexpr const char* kLatched =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline: {sec: 9223372036, nsec: 854775807}\n"
    "  lifespan: {sec: 9223372036, nsec: 854775807}\n  liveliness: 1\n"
    "  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}\n"
    "  avoid_ros_namespace_conventions: false\n";

constexpr const char* kObjects = "vision_msgs/Detection3DArray";

/// Frames map, base_link and one a sensor; channels begin with their first message.
class RosFile final : public ExportFile {
 public:
  RosFile(const std::string& path, const std::vector<std::string>& class_names,
          const std::string& mark)
      : mcap_(path, "ros2"), class_names_(class_names), mark_(mark) {}

  void writePose(Stamp stamp, const Pose3& T_world_ego) override {
    has_poses_ = true;
    transform("/tf", stamp, T_world_ego, ros::kWorld, ros::kVehicle);
  }

  void writeScene(const Scene& scene) override {
    if (!has_poses_)
      transform("/tf", scene.stamp, scene.ego.T_world_ego, ros::kWorld, ros::kVehicle);
    write("/tracks", kObjects, scene.stamp, ros::messageOf(scene, class_names_));
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
    if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) {
      place(frame);
      write("/" + frame.sensor, "radar_msgs/RadarScan", frame.stamp,
            ros::messageOf(*radar, header));
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
    transform("/tf_static", frame.stamp, frame.T_ego_sensor, ros::kVehicle, frame.sensor);
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
      std::map<std::string, std::string> metadata = {{"offered_qos_profiles", qos}};
      if (type == kObjects && !mark_.empty()) metadata["run"] = mark_;
      const auto id = mcap_.addChannel(topic, "cdr", ros::schemaOf(type), metadata);
      known = channels_.emplace(topic, id).first;
    }
    mcap_.write(known->second, stamp, ros::encoded(message, ros::Encoding::kCdr));
  }

  McapWriter mcap_;
  const std::vector<std::string> class_names_;
  const std::string mark_;
  std::map<std::string, std::uint16_t> channels_;
  std::map<std::string, Pose3> placed_;
  bool has_poses_ = false;
};

}  // namespace

std::unique_ptr<ExportFile> makeRosFile(const std::string& path,
                                        const std::vector<std::string>& class_names,
                                        const std::string& mark) {
  return std::make_unique<RosFile>(path, class_names, mark);
}

}  // namespace perception
