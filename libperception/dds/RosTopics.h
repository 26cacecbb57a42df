#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/dds/Network.h"
#include "libperception/dds/RawTopic.h"
#include "libperception/grid/SafetyGrid.h"
#include "libperception/interop/ros/RosDisplay.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// Publishes as ROS 2 nodes do, for its tools. Of scenes: /tracks (vision_msgs/Detection3DArray),
/// /tracks/markers (visualization_msgs/MarkerArray) and, where the scene says so, /stop
/// (std_msgs/Bool), /free_distance and /safe_speed (std_msgs/Float64: m, m/s); /grid
/// (nav_msgs/OccupancyGrid), /diagnostics (diagnostic_msgs/DiagnosticArray), lidar clouds on /LABEL
/// (sensor_msgs/PointCloud2), and the vehicle and its sensors as transforms WORLD, base_link, LABEL
/// (/tf, /tf_static).
class RosTopics {
 public:
  struct Params {
    NetworkName network;
    std::vector<std::string> class_names;
    std::string world_frame = "map";
    bool transforms = true;  ///< also the vehicle's place in the world
  };
  /// Throws Error (kUnavailable).
  explicit RosTopics(Params params);

  void publish(const Scene& scene);
  /// At most once a second, where it has a reader; null: nothing.
  void publish(const Scene& scene, const SafetyGrid* grid);
  /// Clouds; other data have no message.
  void publish(const SensorFrame& frame);
  void publish(Stamp stamp, const std::vector<ros::DiagnosticStatus>& status);

  /// Messages that a reader missed because it could not follow.
  std::uint64_t missed() const { return missed_; }

 private:
  template <class Message>
  void send(const std::string& topic, const char* type, const Message& message,
            bool latched = false);
  void publishTransforms(const std::string& topic, Stamp stamp, const std::string& parent,
                         const std::map<std::string, Pose3>& children);

  const Params params_;
  std::shared_ptr<Network> network_;
  std::map<std::string, std::unique_ptr<RawWriter>> writers_;  ///< by topic
  std::map<std::string, Pose3> mounted_;                       ///< T_ego_sensor by label
  std::optional<std::chrono::steady_clock::time_point> grid_at_;
  std::uint64_t missed_ = 0;
};

}  // namespace perception
