#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libperception/importers/bags/BagContents.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A device's packet inside a message.
struct BagPacket {
  std::string bytes;
  Stamp stamp;  ///< of reception
};

/// A reading of the vehicle's own place or motion, without label and place on the vehicle.
using BagObservation = std::shared_ptr<mrpt::obs::CObservation>;

/// What the import makes of messages of one type, whatever their container and encoding. All of its
/// functions throw std::runtime_error for a message that cannot be.
struct BagType {
  /// Of sensors, in the order in which the one is chosen whose messages are a log's frames.
  enum class Role : std::uint8_t { kCloud, kRadar, kImage, kBoxes, kOther };

  const char* name;  ///< as BagTopic::type; "package/*": all of the package
  const char* use;   ///< for people
  Role role = Role::kOther;
  /// Sets a sensor's data.
  ros::Header (*measure)(const BagMessage&, const BagTopicParams&, SensorFrame&) = nullptr;
  /// Takes what is needed before the sensors' data.
  void (*note)(const BagMessage&, BagContents&) = nullptr;
  /// Raw packets, and the kinds of devices (deviceKinds()) that may have sent them.
  ros::Header (*unpack)(const BagMessage&, std::vector<BagPacket>&) = nullptr;
  std::vector<const char*> devices = {};
  /// Of these devices: what their decoder is made with, by topic; null: nothing.
  std::map<std::string, std::string> BagContents::*device_files = nullptr;
  /// Messages begin with a std_msgs/Header, whose stamp and frame are those of the measurement.
  bool has_header = true;
  /// Makes a reading, with `shift` [s] added to its stamp, and sets its header; null: it says
  /// nothing.
  BagObservation (*observe)(const BagMessage&, double shift, ros::Header&) = nullptr;
  bool of_vehicle = false;  ///< observe: only of messages in the vehicle's frame
  /// Topics may have nothing of a known device: those that have are BagContents::device_topics.
  bool may_be_silent = false;
};

const std::vector<BagType>& bagTypes();
/// tf of ROS 1 wrote frames with a slash before: "velodyne" for "/velodyne".
std::string frameName(const std::string& name);

// Steps that types share.
/// Adds a pose of a topic: the place of its message among those of the topic tells whether it is
/// used.
void addPoseOf(const BagMessage& message, BagContents& contents, const ros::Header& header,
               const ros::Pose& pose, const std::string& frame);
void setCloud(const ros::PointCloud2& cloud, const BagTopicParams& params, SensorFrame& frame);
void setImage(Raster&& raster, SensorFrame& frame);

/// By the topic's type; of types that no row names, by the fields of their definition. Null: it is
/// not read.
const BagType* bagType(const BagTopic& topic);

}  // namespace perception
