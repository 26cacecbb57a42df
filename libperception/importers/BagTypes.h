#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/importers/BagContents.h"
#include "libperception/interop/ReadingBag.h"
#include "libperception/interop/RosMessages.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A device's packet inside a message.
struct BagPacket {
  std::string bytes;
  Stamp stamp;  ///< of reception
};

/// What the import makes of messages of one type, whatever their container and encoding. All of its
/// functions throw std::runtime_error for a message that cannot be.
struct BagType {
  /// Of sensors, in the order in which the one is chosen whose messages are a log's frames.
  enum class Role : std::uint8_t { kCloud, kRadar, kImage, kBoxes, kOther };

  const char* name;  ///< as BagTopic::type
  const char* use;   ///< for people
  Role role = Role::kOther;
  /// Sets a sensor's data.
  ros::Header (*measure)(const BagMessage&, const BagTopicParams&, SensorFrame&) = nullptr;
  /// Takes what is needed before the sensors' data.
  void (*note)(const BagMessage&, BagContents&) = nullptr;
  /// Raw packets, and the kinds of devices (deviceKinds()) that may have sent them.
  ros::Header (*unpack)(const BagMessage&, std::vector<BagPacket>&) = nullptr;
  std::vector<const char*> devices = {};
  /// Messages begin with a std_msgs/Header, whose stamp and frame are those of the measurement.
  bool has_header = true;
};

const std::vector<BagType>& bagTypes();
/// tf of ROS 1 wrote frames with a slash before: "velodyne" for "/velodyne".
std::string frameName(const std::string& name);
/// Null for a type that is not read.
const BagType* bagType(const std::string& type);

}  // namespace perception
