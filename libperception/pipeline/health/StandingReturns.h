#pragma once
#include <bitset>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Where a lidar's last scan met something that stands above the ground: cells of 1 m around the
/// vehicle.
class StandingReturns {
 public:
  void add(const SensorFrame& frame, const LidarCloud& cloud);
  /// Whether the scan met something in the cell of a place (world) or in one beside it. False where
  /// the scan is of long ago.
  bool at(const Vector2& place, Stamp now) const;

 private:
  static constexpr int kCells = 160;  ///< along and across
  /// Empty where the place is beyond the cells.
  static std::optional<std::size_t> cellOf(double x, double y);

  Stamp stamp_;
  Pose3 T_ego_world_ = Pose3::Identity();
  std::bitset<kCells * kCells> cells_;
};

}  // namespace perception
