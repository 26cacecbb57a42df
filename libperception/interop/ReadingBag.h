#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/interop/ByteSource.h"
#include "libperception/interop/RosWire.h"

namespace perception {

/// A topic of a recording.
struct BagTopic {
  std::string name;
  std::string type;  ///< "sensor_msgs/PointCloud2", of ROS 2 too
  ros::Encoding encoding = ros::Encoding::kRos1;
  std::string unknown_encoding;  ///< of messages that are neither ROS 1 nor CDR; else empty
};

struct BagMessage {
  const BagTopic* topic = nullptr;  ///< valid as long as the recording
  Stamp stamp;                      ///< of recording; that of the measurement is in the message
  std::string_view bytes;           ///< valid until the next message
  std::uint64_t offset = 0;         ///< [bytes] in the file: of the message, or of its chunk
};

/// A recording of messages, read from its beginning to its end: records, some of which are
/// (compressed) chunks of records. A damaged chunk is left out; a damaged or missing end keeps what
/// is whole.
class ReadingBag {
 public:
  virtual ~ReadingBag() = default;
  /// False at the end.
  bool next(BagMessage& message);
  /// What was damaged or missing, with file and byte; complete after the end.
  const std::vector<std::string>& faults() const { return faults_; }
  std::uint64_t bytesRead() const { return file_->position(); }
  std::uint64_t fileBytes() const { return file_->size(); }

 protected:
  ReadingBag(std::string path, std::unique_ptr<ByteSource> file)
      : path_(std::move(path)), file_(std::move(file)) {}

  enum class Record { kOther, kMessage, kChunk, kEnd };
  /// Reads one record; sets `message` or chunk_. Throws std::runtime_error.
  virtual Record read(ByteSource& source, BagMessage& message) = 0;
  /// What is wrong with a file that ends here; empty: nothing.
  virtual std::string faultOfEnd(bool ended) const = 0;

  BagTopic& topic(std::uint32_t id) { return topics_[id]; }
  /// Throws std::runtime_error if no record of it came before.
  const BagTopic* knownTopic(std::uint32_t id) const;

  /// A chunk that was read, not inflated yet.
  struct Chunk {
    std::string compression, bytes;
    std::uint64_t size = 0;  ///< inflated
    std::uint32_t crc = 0;   ///< of the inflated bytes; 0: not known
  } chunk_;

 private:
  void open();
  void finish(bool ended);

  std::string path_;
  std::unique_ptr<ByteSource> file_, block_;
  std::uint64_t block_offset_ = 0;
  std::map<std::uint32_t, BagTopic> topics_;
  std::vector<std::string> faults_;
  bool done_ = false;
};

/// Opens a ROS 1 bag (version 2.0) or an MCAP file with messages of ROS 1 or 2, by its first bytes.
/// Throws DataError: missing (kNoInput), or neither.
std::unique_ptr<ReadingBag> openBag(const std::string& path);

/// The files of a recording: `path` itself, or the MCAP files and bags of a folder (as `ros2 bag
/// record` leaves it), by name. Throws DataError (kNoInput).
std::vector<std::string> bagFiles(const std::string& path);

}  // namespace perception
