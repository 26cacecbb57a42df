#pragma once
#include <cstddef>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [m] (assumed) No lidar on a vehicle sees farther.
inline constexpr double kFarthestReturn = 1000;

/// Points of a scan that are no returns, though they have a place.
struct NoReturns {
  /// Indices of points that drivers write where a beam met nothing: those beyond kFarthestReturn;
  /// and those at the farthest range of the others, from 20 m on, if at least 5 % and 50 points
  /// have that range, within 2 mm or 1e-5 of it, hardly any (a tenth of them) are up to 2 %
  /// nearer, and they are not all of one beam below the horizon. Farther than everything else and
  /// the same in many directions is no scene: a wall is farther beside the foot of the
  /// perpendicular, and a beam's ring on the ground has one elevation.
  std::vector<std::size_t> points;
  /// Most points lie beyond kFarthestReturn, at ranges that differ or with nothing nearer: the
  /// coordinates have another unit, or the origin is not at the sensor.
  bool elsewhere = false;
};
NoReturns noReturnsOf(const LidarCloud& cloud);

/// Makes their places NaN; gives how many they are. All other columns stay as they are.
std::size_t clear(const NoReturns& none, LidarCloud& cloud);

}  // namespace perception
