#pragma once
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// What of a return's intensity tells one surface from another.
enum class IntensityKind {
  kUsable,
  kNone,  ///< no field
  kFlat,  ///< one value for all: 0, or a constant
  kSteps  ///< a handful of values
};

/// Which fields the scans of a lidar have. A missing field is not used as evidence
/// (method.md 8.10).
struct LidarInputs {
  IntensityKind intensity = IntensityKind::kUsable;
  bool rings = false, times = false, echoes = false, labels = false;
  bool ordered = false;  ///< by the sweep: neighbors in the list are neighbors in direction
  int beams = 0;         ///< by their numbers; 0: not told

  /// Of one scan; kUsable where it has no returns.
  static LidarInputs of(const LidarCloud& cloud);
  bool operator==(const LidarInputs& other) const;
  /// What is missing or unusual, in words; empty: nothing.
  std::string missing() const;
};

/// A scan's intensities; ends at the first returns where they are usable.
IntensityKind intensityKindOf(const LidarCloud& cloud);

}  // namespace perception
