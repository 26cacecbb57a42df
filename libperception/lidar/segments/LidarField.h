#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/lidar/segments/DirectionCells.h"

namespace perception {

/// The azimuths in which a scan has returns at any elevation. A wide gap between them lies outside
/// the lidar's field of view, behind what is mounted beside it, or was cut out of the recording:
/// what stands there is not seen, and what ends there may go on.
class LidarField {
 public:
  /// [rad] 30 degrees: least gap without any return (assumed: what absorbs the beams of all
  /// elevations, also those on the ground, is narrower)
  static constexpr double kLeastGap = kPi / 6;

  /// The whole circle.
  LidarField() = default;
  /// `any` of equal columns, counter-clockwise from azimuth 0 on: whether one has a return.
  explicit LidarField(const std::vector<std::uint8_t>& any);

  bool isWhole() const { return outside_.empty(); }
  /// Whether the lidar looks there; columns wrap around.
  bool has(int column) const;
  /// The same of an azimuth [rad] about the sensor, in the axes of the columns.
  bool hasAzimuth(double azimuth) const;

 private:
  std::vector<std::uint8_t> outside_;  ///< of the columns; empty: the whole circle
};

/// By the columns of the cells; `height` [m] of each point above the ground, which is below
/// `ground`. The whole circle where the scan has no ground in half of its columns: it may hold
/// objects alone.
LidarField fieldOf(const DirectionCells& cells, const std::vector<float>& height, double ground);

}  // namespace perception
