#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/lidar/LidarDetections.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/frames/EarlierScan.h"

namespace perception {

/// How fast clusters move along the line of sight, by the ranges in which two scans of one lidar
/// show them in the same directions (method.md 8.11). What is rigid has moved by the same way in
/// all of them; flakes, drops and leaves have not.
class RadialMotion {
 public:
  /// `ego` and `stamp` are those of `now`, whose obstacles the clusters consist of.
  RadialMotion(const EarlierScan& before, const LidarDetections& now, const EgoState& ego,
               Stamp stamp);

  /// The velocity of a cluster along the normal of the surface that it shows. Empty: too few
  /// directions tell, they disagree, or the surface is seen at a grazing angle, along which it
  /// could move unseen. `points`: indices into the obstacles.
  std::optional<RadialSpeed> of(const std::vector<std::uint32_t>& points) const;

 private:
  struct Return {
    float x, y, range, height;  ///< [m] from the sensor, in the ego axes of now
  };

  const LidarDetections& now_;
  EgoState ego_;
  double dt_;                      ///< [s]
  std::vector<Return> before_;     ///< by bin of azimuth
  std::vector<std::uint32_t> at_;  ///< first of each bin in before_, and their number
};

}  // namespace perception
