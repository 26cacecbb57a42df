#pragma once
#include <map>
#include <string>

#include "libperception/measurement/LidarInputs.h"
#include "libperception/scene/EventLog.h"

namespace perception {

/// Looks at what the scans of each lidar hold: intensities that tell nothing are taken out, so that
/// no stage takes them for evidence, and what is missing is said once (event `lidar_inputs`).
class InputWatch {
 public:
  explicit InputWatch(EventLog& events) : events_(events) {}

  /// A frame before it is used; no effect on one without a point cloud.
  void apply(SensorFrame& frame);

 private:
  EventLog& events_;
  std::map<std::string, int> looks_;  ///< scans looked at, by lidar
};

}  // namespace perception
