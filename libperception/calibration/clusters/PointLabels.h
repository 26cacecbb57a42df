#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace perception {

/// Labels 110 and 112 to 118: snow, rain, fog, spray, exhaust, mirror, noise, dirt
/// (simulation/lidar/PointTruth.h); 111 is lying snow.
bool isPhantomLabel(std::uint16_t label);

/// Labels of the points of a log's scans in SemanticKITTI's layout (one uint32 a point, the class
/// in its lower half: 10 car, 30 person ...), as perception-import puts them beside a log:
/// FILE_Labels/NUMBER.label[.gz].
class PointLabels {
 public:
  /// The labels beside FILE.rawlog; none where there is no such folder.
  explicit PointLabels(const std::string& rawlog);
  bool any() const { return !files_.empty(); }
  /// Classes of a frame's points; empty where the frame has none. Throws DataError where the file
  /// cannot be read or does not hold `points` labels.
  std::optional<std::vector<std::uint16_t>> ofFrame(std::int64_t frame, std::size_t points) const;

 private:
  std::map<std::int64_t, std::string> files_;  ///< by frame number
};

}  // namespace perception
