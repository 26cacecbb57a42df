#pragma once
#include <cmath>
#include <cstddef>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [s] Longest time of a scan, and between its stamp and its returns (assumed: slow scanners turn
/// once a second).
inline constexpr double kLongestScan = 1.05;

/// Whether a return of the scan has a time that cannot be of it: other units, or another clock than
/// the stamp's. Without such times the scan can be used, with them its returns would be moved far.
inline bool timesOutsideOf(const LidarCloud& cloud) {
  for (std::size_t i = 0; i < cloud.time_offset.size() && i < cloud.size(); ++i) {
    const bool is_return = std::isfinite(cloud.x[i] + cloud.y[i] + cloud.z[i]);
    const auto t = static_cast<double>(cloud.time_offset[i]);
    if (is_return && !(std::abs(t) <= kLongestScan)) return true;
  }
  return false;
}

}  // namespace perception
