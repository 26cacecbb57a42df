#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libperception/capture/ros/RosPoses.h"
#include "libperception/config/Config.h"
#include "libperception/importers/bags/BagMeasurements.h"
#include "libperception/importers/bags/DoubledMessages.h"
#include "libperception/importers/bags/MessageTimes.h"
#include "libperception/interop/ros/RosGraphParams.h"

namespace perception {

/// A topic of a running graph, as one of a recording; `type` as "sensor_msgs/PointCloud2".
BagTopic liveTopic(const std::string& topic, const std::string& type);

/// Makes observations of the messages of a running ROS 2 graph as they come, by the INI and with
/// the readers of perception-import bag. Nothing is known before it came: sensor data waits for the
/// place of its frame on the vehicle, a pose for the other steps between world and vehicle, each
/// for a while.
class RosIntake {
 public:
  using Give = RosPoses::Give;

  /// Reads [bag], [ros] and [topic.TOPIC]. Throws ConfigError.
  RosIntake(Config& config, Give give);

  const RosGraphParams& graph() const { return graph_; }
  /// Whether the INI wants messages of a topic of that type ("sensor_msgs/PointCloud2"), and we
  /// read them.
  bool wants(const std::string& topic, const std::string& type) const;
  /// Of a topic with data that is large or comes seldom; others are poses, inertial units and the
  /// like.
  static bool isLarge(const std::string& type);

  /// One message of a topic that wants() said yes to. What cannot be read is counted.
  void take(const std::string& topic, const std::string& type, std::string bytes, Stamp received);
  /// Gives what has waited long enough; `now` by the clock of `received`.
  void tend(Stamp now);
  /// Gives all that waits.
  void finish();

  std::uint64_t received() const { return received_; }
  std::uint64_t unreadable() const;
  std::uint64_t late() const;  ///< messages stamped before the one before, of all topics
  /// What was read, a line each.
  std::vector<std::string> notes() const;
  /// Faults for the user, a line each.
  std::vector<std::string> warnings() const;

 private:
  struct Waiting {
    std::string topic, bytes;
    Stamp received;
    ros::Header header;
  };
  struct Topic {
    std::uint64_t late = 0;  ///< stamped before the one before
    std::uint64_t unreadable = 0;
    std::string first_fault;
    std::optional<Stamp> newest;
    std::deque<MessageTimes> times;  ///< the newest ones
  };
  void read(const BagMessage& message, std::string&& bytes);
  void noteHeader(const BagMessage& message, const ros::Header& header);
  bool isReady(const Waiting& waiting, Stamp now);
  void measure(const Waiting& waiting);
  void giveFrame(const std::string& topic, bool first, SensorFrame&& frame);
  void chooseBase(Stamp now);
  bool waitedSince(std::optional<Stamp> since, Stamp now) const;
  void guarded(const std::string& topic, const std::function<void()>& work);

  BagParams bag_;
  RosGraphParams graph_;
  BagTopicParamsByName topic_params_;
  Give give_;
  BagContents contents_;
  BagMeasurements measurements_;
  RosPoses poses_;
  std::map<std::string, Topic> topics_;
  std::uint64_t received_ = 0, left_out_ = 0;
  std::optional<Stamp> began_;  ///< first data of a sensor
  std::string base_;
  bool has_base_ = false;
  std::set<std::pair<std::string, std::string>> given_up_;  ///< topic, frame without a place
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::string frames_topic_;
  std::int64_t frame_ = -1;
  DoubledMessages doubles_;
  std::map<std::string, std::size_t> no_returns_;  ///< by sensor: points
  std::map<std::string, std::int64_t> timeless_;   ///< by sensor: scans without their times
};

}  // namespace perception
