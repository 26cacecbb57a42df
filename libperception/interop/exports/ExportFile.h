#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/scene/Scene.h"

namespace perception {

/// A log and its tracks in the messages of other tools, written as they come, by time.
class ExportFile {
 public:
  virtual ~ExportFile() = default;
  /// A pose of the vehicle that the log has.
  virtual void writePose(Stamp stamp, const Pose3& T_world_ego) = 0;
  /// The objects of an instant.
  virtual void writeScene(const Scene& scene) = 0;
  /// A scan or an image, with the vehicle's pose in frame.ego. False for data without a message of
  /// their own: radar, boxes, images that are not there.
  virtual bool writeFrame(const SensorFrame& frame) = 0;
  /// Completes the file; returns the number of messages. Throws OutputError (kIoError).
  virtual std::uint64_t close() = 0;
};

/// MCAP of Foxglove's messages in JSON. `class_names`: indexed by class_id; `mark`: runMark(), in
/// the metadata of the channel of tracks. Throws OutputError.
std::unique_ptr<ExportFile> makeFoxgloveFile(const std::string& path,
                                             const std::vector<std::string>& class_names,
                                             const std::string& mark);
/// MCAP of ROS 2 messages in CDR, as `ros2 bag` and perception-import bag read it.
std::unique_ptr<ExportFile> makeRosFile(const std::string& path,
                                        const std::vector<std::string>& class_names,
                                        const std::string& mark);

}  // namespace perception
