#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/lidar/LidarDetections.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/frames/EarlierScan.h"

namespace perception {

/// A cluster that has moved since the scan before.
struct MovingCluster {
  RadialSpeed speed;  ///< along the normal of the surface that it shows
  /// Indices into the obstacles: its surface and what lies behind it, where a cloud that does not
  /// move alike hangs before it. Empty: none does.
  std::vector<std::uint32_t> behind_cloud;
  bool behindACloud() const { return !behind_cloud.empty(); }
};

/// How fast clusters move along the line of sight, by the ranges that two scans of one lidar show
/// in the same directions (method.md 8.16). Of what is rigid all have changed by the same way; of
/// spray, flakes and leaves they have not.
class RadialMotion {
 public:
  /// `ego` and `stamp` are those of `now`, whose obstacles the clusters consist of. Both must
  /// outlive this.
  RadialMotion(const EarlierScan& before, const LidarDetections& now, const EgoState& ego,
               Stamp stamp);

  /// The motion of a cluster. Empty: it is slower than 3 m/s, too few directions tell, they
  /// disagree, or its surface is seen at a grazing angle, along which it could move unseen.
  /// `points`: indices into the obstacles.
  std::optional<MovingCluster> of(const std::vector<std::uint32_t>& points) const;

 private:
  /// From the sensor, in the ego axes of now.
  struct Return {
    float x, y, range, height;  ///< [m]
  };
  class Cells;

  std::vector<Return> returnsOf(const std::vector<std::uint32_t>& points) const;

  const LidarDetections& now_;
  const EgoState& ego_;
  double dt_;                      ///< [s]
  std::vector<Return> before_;     ///< by bin of azimuth
  std::vector<std::uint32_t> at_;  ///< first of each bin in before_, and their number
};

}  // namespace perception
