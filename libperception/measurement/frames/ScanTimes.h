#pragma once
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [s] Longest time of a scan, and between its stamp and its returns (assumed: slow scanners turn
/// once a second).
inline constexpr double kLongestScan = 1.05;

/// Whether a point of a cloud is a return: it has a place, and not that of the sensor.
inline bool isReturn(const LidarCloud& cloud, std::size_t i) {
  const float size = std::abs(cloud.x[i]) + std::abs(cloud.y[i]) + std::abs(cloud.z[i]);
  return size > 0 && std::isfinite(size);
}

/// Whether a return of the scan has a time that cannot be of it: other units, or another clock than
/// the stamp's. Without such times the scan can be used, with them its returns would be moved far.
inline bool timesOutsideOf(const LidarCloud& cloud) {
  for (std::size_t i = 0; i < cloud.time_offset.size() && i < cloud.size(); ++i) {
    const auto t = static_cast<double>(cloud.time_offset[i]);
    if (isReturn(cloud, i) && !(std::abs(t) <= kLongestScan)) return true;
  }
  return false;
}

/// The time of the earliest return, of one time a point in any unit: points that are no returns
/// (not finite, or at the sensor itself) may have any. The first time where there is no return; 0
/// of none.
inline double earliestOf(const std::vector<double>& times, const LidarCloud& cloud) {
  double earliest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < times.size() && i < cloud.size(); ++i) {
    if (isReturn(cloud, i) && times[i] < earliest) earliest = times[i];
  }
  if (std::isfinite(earliest)) return earliest;
  return times.empty() ? 0 : times.front();
}

}  // namespace perception
