#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/importers/ImportLog.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A box that a person drew, in the lidar's frame.
struct DataSetBox {
  std::string id;    ///< the same for an object throughout a drive
  std::string type;  ///< the truth's
  ObjectDetection::SpaceBox box;
};

// Readers of the files of data sets. They throw DataError: missing (kNoInput), else with the place
// and what was expected.

/// CADC: SEQ/3d_ann.json, boxes by number of the frame. dimensions: x is the width, y the length.
std::vector<std::vector<DataSetBox>> readCadcBoxes(const std::string& path);
/// Boreas: labels_tracking/US.txt: uuid type length width height x y z yaw points.
std::vector<DataSetBox> readBoreasBoxes(const std::string& path);
/// SemanticSpray++: object_labels/lidar/NNNNNN.json. Without a class and a number of its own a box
/// is a Car and has its place in the file.
std::vector<DataSetBox> readSprayBoxes(const std::string& path);

/// Writes boxes as rows of a log's truth; numbers their objects in order of appearance.
class BoxTruth {
 public:
  explicit BoxTruth(ImportLog& log) : log_(log) {}
  void add(const std::vector<DataSetBox>& boxes, std::int64_t frame, Stamp stamp,
           const Pose3& T_world_lidar, const LidarCloud& cloud);

 private:
  ImportLog& log_;
  std::map<std::string, std::int64_t> numbers_;  ///< by id
};

}  // namespace perception
