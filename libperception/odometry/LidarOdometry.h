#pragma once
#include <optional>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/odometry/VoxelMap.h"

namespace perception {

/// The vehicle's motion from scans of one lidar: every scan is registered to the surfaces of those
/// before it, point to plane, from the last motion on (method.md 1.7). A function of the scans
/// alone.
class LidarOdometry {
 public:
  LidarOdometry();

  /// Pose of the vehicle at the frame's stamp in the world frame, that of the vehicle at the first
  /// scan. Empty for frames without a point cloud or with a stamp that is not later than the last.
  std::optional<Pose3> update(const SensorFrame& frame);
  /// Number of scans that could not be registered: their pose is that of the motion before.
  std::uint64_t lost() const { return lost_; }
  void clear() { *this = LidarOdometry(); }

 private:
  struct Fit {
    Pose3 T_world_ego = Pose3::Identity();
    double standing = 0;  ///< sum of the weights of points on what stands
    bool good = false;
  };
  Fit registered(const std::vector<Vector3>& points, Pose3 T, int steps) const;
  Pose3 start(const std::vector<Vector3>& points, double dt) const;

  VoxelMap map_;
  Pose3 T_world_ego_ = Pose3::Identity();
  Pose3 motion_ = Pose3::Identity();  ///< of the last step, vehicle frame
  double step_ = 0;                   ///< [s] of it; 0: none yet
  int steps_ = 0;                     ///< since the motion was unknown
  std::optional<Stamp> stamp_;
  std::uint64_t lost_ = 0;
};

}  // namespace perception
