#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libperception/dds/Network.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// Publishes as ROS 2 nodes do, for its tools: scenes on /tracks (vision_msgs/Detection3DArray, in
/// the frame map), lidar clouds on /LABEL (sensor_msgs/PointCloud2), the vehicle and its sensors as
/// transforms map, base_link, LABEL (/tf, /tf_static).
class RosTopics {
 public:
  /// Throws Error (kUnavailable).
  RosTopics(const NetworkName& name, std::vector<std::string> class_names);

  void publish(const Scene& scene);
  /// Clouds; other data have no message.
  void publish(const SensorFrame& frame);

 private:
  void publishTransforms(int writer, Stamp stamp, const std::string& parent,
                         const std::map<std::string, Pose3>& children);

  std::shared_ptr<Network> network_;
  std::vector<std::string> class_names_;
  int tracks_ = 0, transforms_ = 0, static_transforms_ = 0;
  std::map<std::string, int> clouds_;     ///< writers by label
  std::map<std::string, Pose3> mounted_;  ///< T_ego_sensor by label
};

}  // namespace perception
