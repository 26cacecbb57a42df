#pragma once
#include <optional>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Where the vehicle was at any time of the log, interpolated between the log's poses.
class Course {
 public:
  /// `poses` in any order. Of several poses with the same stamp the first is used.
  explicit Course(std::vector<EgoState> poses);

  /// T_world_ego at `stamp` plus `later` [s]. Empty before the first pose, after the last one, and
  /// between two poses that lie more than 1 s apart.
  std::optional<Pose3> at(Stamp stamp, double later) const;
  /// The motion between two instants, in the vehicle frame of the first one: takes points of the
  /// frame at `to` to the frame at `from`. Both instants are moved by `later` [s]. Empty where at()
  /// is empty for one of them.
  std::optional<Pose3> motion(Stamp from, Stamp to, double later) const;

 private:
  std::vector<EgoState> poses_;  // in order of time
};

}  // namespace perception
