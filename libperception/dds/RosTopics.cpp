#include "libperception/dds/RosTopics.h"

#include <utility>
#include <variant>

#include "libperception/dds/RosGraph.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosScene.h"
#include "libperception/interop/ros/RosSensors.h"

namespace perception {
namespace {

constexpr const char* kTransforms = "/tf";
constexpr const char* kStatic = "/tf_static";
constexpr const char* kGrid = "/grid";
constexpr auto kBetweenMaps = std::chrono::seconds(1);
constexpr double kMapReach = 60;  // [m] around the vehicle

}  // namespace

RosTopics::RosTopics(Params params)
    : params_(std::move(params)), network_(Network::join(params_.network)) {}

template <class Message>
void RosTopics::send(const std::string& topic, const char* type, const Message& message,
                     bool latched) {
  auto& writer = writers_[topic];
  if (!writer) {
    TopicQuality quality;
    quality.latched = latched;
    writer = std::make_unique<RawWriter>(network_, wireTopicOf(topic), wireTypeOf(type), quality);
  }
  if (!writer->write(ros::encoded(message, ros::Encoding::kCdr))) ++missed_;
}

void RosTopics::publish(const Scene& scene) {
  if (params_.transforms)
    publishTransforms(kTransforms, scene.stamp, params_.world_frame,
                      {{ros::kVehicle, scene.ego.T_world_ego}});
  ros::Detection3DArray boxes = ros::messageOf(scene, params_.class_names);
  boxes.header.frame_id = params_.world_frame;
  for (ros::Detection3D& box : boxes.detections) box.header.frame_id = params_.world_frame;
  send("/tracks", "vision_msgs/Detection3DArray", boxes);
  send("/tracks/markers", "visualization_msgs/MarkerArray",
       ros::marksOf(scene, params_.world_frame, params_.class_names));
  if (!scene.path) return;
  send("/stop", "std_msgs/Bool",
       ros::Plain<std::uint8_t>{static_cast<std::uint8_t>(scene.path->stop)});
  send("/free_distance", "std_msgs/Float64", ros::Plain<double>{scene.path->distance});
  send("/safe_speed", "std_msgs/Float64", ros::Plain<double>{scene.path->safe_speed});
}

void RosTopics::publish(const Scene& scene, const SafetyGrid* grid) {
  const auto now = std::chrono::steady_clock::now();
  if (grid == nullptr || (grid_at_ && now - *grid_at_ < kBetweenMaps)) return;
  grid_at_ = now;
  const auto writer = writers_.find(kGrid);
  if (writer != writers_.end() && !writer->second->hasReaders()) return;
  std::string data;
  send(kGrid, "nav_msgs/OccupancyGrid",
       ros::mapOf(scene, params_.world_frame, grid->knownCells(), grid->params().resolution,
                  kMapReach, data));
}

void RosTopics::publish(const SensorFrame& frame) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return;
  const auto [mounted, is_new] = mounted_.try_emplace(frame.sensor, frame.T_ego_sensor);
  if (is_new || !mounted->second.isApprox(frame.T_ego_sensor, 1e-12)) {
    mounted->second = frame.T_ego_sensor;
    publishTransforms(kStatic, frame.stamp, ros::kVehicle, mounted_);
  }
  std::string data;
  send("/" + frame.sensor, "sensor_msgs/PointCloud2",
       ros::messageOf(*cloud, ros::Header{frame.stamp, frame.sensor}, data));
}

void RosTopics::publish(Stamp stamp, const std::vector<ros::DiagnosticStatus>& status) {
  send("/diagnostics", "diagnostic_msgs/DiagnosticArray",
       ros::DiagnosticArray{ros::Header{stamp, ""}, status});
}

void RosTopics::publishTransforms(const std::string& topic, Stamp stamp, const std::string& parent,
                                  const std::map<std::string, Pose3>& children) {
  ros::TFMessage all;
  for (const auto& [child, T] : children)
    all.transforms.push_back({{stamp, parent}, child, ros::messageOf(T)});
  send(topic, "tf2_msgs/TFMessage", all, topic == kStatic);
}

}  // namespace perception
