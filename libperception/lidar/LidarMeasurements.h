#pragma once
#include <memory>

#include "libperception/lidar/LidarFrontEnd.h"

namespace perception {

/// Heights of the ground and of the returns that one scan's measurements share.
struct ScanContext {
  const SensorFrame& frame;
  const LidarDetections& found;
  const LidarParams& params;
  Pose3 T_world_sensor;
  const OcclusionMap& occlusion;
  double fov;        ///< [rad]
  double top_slope;  ///< [-] tangent of the highest beam's elevation
};

/// The second nearest hiding return of every direction: a single one may be a flake, a drop or a
/// twig.
std::shared_ptr<const OcclusionMap> occlusionMapOf(const LidarDetections& found,
                                                   const Pose3& T_world_ego,
                                                   const Pose3& T_world_sensor,
                                                   const ObstacleParams& params);

/// Tangent of the highest beam's elevation. A sample of the returns tells as much: the highest beam
/// has its share of them.
double topSlope(const LidarDetections& found);

/// What a detection is as a measurement, in the world.
Measurement measurementOf(const ScanContext& scan, const Cluster& cluster);
Measurement measurementOf(const ScanContext& scan, const PersonPeak& peak);

}  // namespace perception
