#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/importers/bags/MessageTimes.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/PoseSeries.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/TransformTree.h"

namespace perception {

/// [bag]: whose poses and frames a recording is imported with. Empty: found.
struct BagParams {
  std::string base_frame;         ///< of the vehicle
  std::vector<double> base_pose;  ///< of that frame on the vehicle (ego origin: on the ground)
  std::string poses;              ///< tf, none, or a topic

  void visit(ParamVisitor& v);
};

/// [topic.TOPIC]: one topic.
struct BagTopicParams {
  std::string label;         ///< sensor label in the log
  std::vector<double> pose;  ///< of the sensor on the vehicle; wins over the recording's
  double intensity_max = 0;  ///< intensities are divided by it
  /// What clouds are of; auto: of a radar if they have range rates and no beam numbers.
  enum class Kind { kAuto, kLidar, kRadar } kind = Kind::kAuto;
  double rate_scale = 1;  ///< chosen: of a radar's range rates; -1 where approaching is positive
  bool use = true;        ///< chosen: what can be read is read

  void visit(ParamVisitor& v);
};

/// x y z [m], yaw pitch roll [deg].
Pose3 poseOfNumbers(const std::vector<double>& numbers);

/// What a recording holds, but for the data of its sensors.
struct BagContents {
  struct Row {
    BagTopic topic;
    std::uint64_t messages = 0;
    Stamp first, last;  ///< of recording
  };
  /// The poses of a frame in its last parent, in order of recording.
  struct Transforms {
    std::string parent;
    bool fixed = false;
    PoseSeries poses;
    std::vector<MessageTimes> times;  ///< of each, where it moves
  };
  /// Poses of one topic.
  struct Poses {
    std::string frame;     ///< whose poses they are; empty: not said
    bool on_call = false;  ///< may be a plan: used only if the INI names it
    PoseSeries poses;
    std::vector<std::uint32_t> messages;  ///< of each pose: its number within the topic
  };

  std::map<std::string, Row> topics;
  TransformTree tree;
  std::map<std::string, Transforms> transforms;  ///< by child, while it is read
  std::set<std::string> bad_transforms;          ///< children that have some that are no pose
  /// By topic; of transforms by "transforms of CHILD".
  std::map<std::string, MessageClock> clocks;
  std::map<std::string, Poses> poses;              ///< by topic
  std::map<std::string, ros::CameraInfo> cameras;  ///< first message by topic
  std::map<std::string, std::string> metadata;     ///< of devices, by topic
  std::map<std::string, std::string> difop;        ///< of RoboSense: a packet, by topic
  std::set<std::string> device_topics;             ///< those with packets of a known device, of
                                                   ///< types that may have none
  /// Of messages with a header, by topic: the frames of reference, in order of their appearance.
  std::map<std::string, std::vector<std::string>> frames;
  std::vector<std::string> faults;   ///< damage, messages that cannot be read or used
  std::vector<std::string> remarks;  ///< not damage, but a user should know it
};

/// Reads all messages of a file or folder once.
BagContents readContents(const std::string& path);

/// One line per topic: messages, type, rate, and what the import makes of it. For types that it
/// does not read, the fields follow.
std::string listOf(const BagContents& contents);

/// A line for each topic that the import does not read: messages, type and, where its definition
/// travels with the recording, fields.
std::vector<std::string> unreadTopics(const BagContents& contents);

/// The header that messages of a type begin with; empty: they have none, or are not read. Throws
/// std::runtime_error.
std::optional<ros::Header> headerOf(const BagMessage& message);

/// What the import makes of a topic's messages; empty: nothing.
std::string useOfTopic(const BagTopic& topic);

}  // namespace perception
