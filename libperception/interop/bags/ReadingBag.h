#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/interop/bags/ByteSource.h"
#include "libperception/interop/ros/RosWire.h"

namespace perception {

/// A topic of a recording.
struct BagTopic {
  std::string name;
  std::string type;  ///< "sensor_msgs/PointCloud2", of ROS 2 too
  ros::Encoding encoding = ros::Encoding::kRos1;
  std::string unknown_encoding;  ///< of messages that are neither ROS 1 nor CDR; else empty
  std::string definition;        ///< ROS's text of the type, where it travels with the recording
};

struct BagMessage {
  const BagTopic* topic = nullptr;  ///< valid as long as the recording
  Stamp stamp;                      ///< of recording; that of the measurement is in the message
  std::string_view bytes;           ///< valid until the next message
  std::uint64_t offset = 0;         ///< [bytes] in the file: of the message, or of its chunk
  bool in_row = false;              ///< of a database: `offset` is its number there
  /// "byte 4117" or "row 7".
  std::string place() const;
};

/// A recording of messages, read from its beginning to its end. What is damaged is left out, what
/// is whole is given.
class ReadingBag {
 public:
  virtual ~ReadingBag() = default;
  /// False at the end. Messages that were compressed one by one are inflated.
  bool next(BagMessage& message);
  /// What was damaged or missing, with file and place; complete after the end.
  const std::vector<std::string>& faults() const { return faults_; }
  virtual std::uint64_t bytesRead() const = 0;
  virtual std::uint64_t fileBytes() const = 0;

 protected:
  explicit ReadingBag(std::string path) : path_(std::move(path)) {}
  /// The next message as it was stored.
  virtual bool nextStored(BagMessage& message) = 0;
  /// "sensor_msgs/PointCloud2" for "sensor_msgs/msg/PointCloud2".
  static std::string shortType(std::string type);

  std::string path_;
  std::vector<std::string> faults_;

 private:
  std::string inflated_;  ///< the last message that was compressed
  std::uint64_t unreadable_ = 0;
};

/// Opens a ROS 1 bag (version 2.0), an MCAP file with messages of ROS 1 or 2 or an sqlite file of
/// rosbag2, by its first bytes; each also as one zstd file, which is inflated into the folder of
/// temporary files. Throws DataError: missing (kNoInput), or none of them.
std::unique_ptr<ReadingBag> openBag(const std::string& path);

/// The files of a recording: `path` itself, or the files of a folder (as `ros2 bag record` leaves
/// it) in the order of the numbers in their names. Throws DataError (kNoInput).
std::vector<std::string> bagFiles(const std::string& path);

/// A contradiction between rosbag2's metadata.yaml and the number of messages that were read from
/// the folder; for sqlite files, whose end shows nothing, also that this file is missing. Empty:
/// all is well.
std::string faultOfBagFolder(const std::string& path, std::uint64_t messages);

}  // namespace perception
