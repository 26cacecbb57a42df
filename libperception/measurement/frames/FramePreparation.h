#pragma once
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Prepares the frames of one sensor before its front end sees them. It may remember earlier
/// frames; front ends do not.
class FramePreparation {
 public:
  virtual ~FramePreparation() = default;
  /// Frames in order of time.
  virtual void apply(SensorFrame& frame) = 0;
  /// The world frame or the clock changed: places and stamps of earlier frames are of no use.
  virtual void restart() = 0;
  /// What was learned, as "key = value" lines of the sensor's INI sections.
  virtual std::vector<std::string> learned() const = 0;
};

}  // namespace perception
