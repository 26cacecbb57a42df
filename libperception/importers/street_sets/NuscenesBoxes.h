#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// A 3D box of a detector in the frame of the poses: x of `pose` along the length, z up.
struct WorldBox {
  std::int64_t frame = 0;
  std::string name;  ///< detection_name
  double score = 0;
  Pose3 pose = Pose3::Identity();            ///< of the center
  double length = 0, width = 0, height = 0;  ///< [m]
};

/// True if the file's first character is that of a JSON object.
bool isJsonFile(const std::string& path);

/// Boxes in the format of nuScenes' detection results: {"results": {SAMPLE: [{"translation": [x, y,
/// z] of the center, "size": [width, length, height], "rotation": [w, x, y, z], "detection_name",
/// "detection_score"}, ...]}}; SAMPLE is the number of the frame. Other members are not used. In
/// the order of the file. Throws DataError: kNoInput when it is missing, else with file, line and
/// what was expected.
std::vector<WorldBox> readNuscenesBoxes(const std::string& path);

}  // namespace perception
