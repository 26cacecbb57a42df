#pragma once
#include <map>
#include <string>

#include "libperception/measurement/frames/LidarInputs.h"
#include "libperception/scene/files/EventLog.h"

namespace perception {

/// Checks which fields the scans of each lidar have. It removes intensities that carry no
/// information, so that no stage takes them for evidence, and reports once what is missing (event
/// `lidar_inputs`).
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
