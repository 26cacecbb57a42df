#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/dds/Network.h"
#include "libperception/dds/RawTopic.h"

namespace perception {

// Names that ROS 2 gives topics and types on the wire (rmw: namespace_prefix, message type
// support).

/// "rt/lidar/points" of "/lidar/points".
std::string wireTopicOf(const std::string& topic);
/// Its inverse; empty for what is no topic of ROS (services, actions' parts).
std::optional<std::string> rosTopicOf(const std::string& wire);
/// "sensor_msgs::msg::dds_::PointCloud2_" of "sensor_msgs/PointCloud2".
std::string wireTypeOf(const std::string& type);
/// Its inverse; empty for what is no message of ROS.
std::optional<std::string> rosTypeOf(const std::string& wire);

/// A topic that is written somewhere in the graph.
struct GraphTopic {
  std::string type;         ///< "sensor_msgs/PointCloud2"; of the first writer
  std::size_t writers = 0;  ///< of that type
  std::size_t others = 0;   ///< of another one: they are not read
  TopicQuality quality;     ///< that all writers offer
  bool operator==(const GraphTopic& o) const {
    return type == o.type && writers == o.writers && others == o.others && quality == o.quality;
  }
};

/// What the processes of a ROS 2 graph write, as the middleware finds it out.
class RosGraph {
 public:
  /// Throws Error (kUnavailable).
  explicit RosGraph(std::shared_ptr<Network> network);
  ~RosGraph();
  RosGraph(const RosGraph&) = delete;
  RosGraph& operator=(const RosGraph&) = delete;

  /// By name ("/lidar/points"), as known now.
  std::map<std::string, GraphTopic> look();

 private:
  struct Writer {
    std::string topic, type;
    TopicQuality quality;
  };

  std::shared_ptr<Network> network_;
  int reader_ = 0;
  std::map<std::uint64_t, Writer> writers_;  ///< by instance of the middleware's own topic
};

}  // namespace perception
