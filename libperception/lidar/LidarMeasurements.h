#pragma once
#include <memory>

#include "libperception/lidar/LidarFrontEnd.h"

namespace perception {

/// Data shared by the measurements of one scan.
struct ScanContext {
  const SensorFrame& frame;
  const LidarDetections& found;
  const LidarParams& params;
  Pose3 T_world_sensor;
  const OcclusionMap& occlusion;
  double fov;       ///< [rad]
  bool classified;  ///< clusters are told by their shape
};

/// Occlusion map from the second nearest occluding return of every direction: a single one may be a
/// snowflake, a drop or a twig.
std::shared_ptr<const OcclusionMap> occlusionMapOf(const LidarDetections& found,
                                                   const Pose3& T_world_ego,
                                                   const Pose3& T_world_sensor,
                                                   const ObstacleParams& params);

/// Converts a detection into a measurement (z, R), world frame.
Measurement measurementOf(const ScanContext& scan, const Cluster& cluster);
Measurement measurementOf(const ScanContext& scan, const PersonPeak& peak);
/// The same of a judged cluster with its described outline; `log_class` is left to the caller.
Measurement measurementOf(const ScanContext& scan, const JudgedCluster& cluster, Cluster outline);

}  // namespace perception
