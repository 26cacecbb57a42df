#pragma once
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/lidar/segments/LidarField.h"
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {

/// Outline of a group of returns seen from the sensor, in the horizontal plane.
struct Outline {
  double left = 0, right = 0;  ///< [rad] bearings, counter-clockwise off the sensor's forward axis
  double left_range = 0, right_range = 0;        ///< [m] of the edges
  double nearest = 0;                            ///< [m] range of the nearest point
  Vector2 nearest_direction = Vector2::UnitX();  ///< unit vector to it, world
  bool left_hidden = false,
       right_hidden = false;  ///< an occluder, or no field, just outside the edge
};

/// Outline of a hull (world, [m]) seen from the sensor, which must be outside the hull.
Outline outlineOf(const std::vector<Vector2>& hull, const Pose3& T_world_sensor);

/// Marks edges as hidden beside which the occlusion map is nearer by more than `margin` [m], or at
/// the border of the field of view `fov` [rad]; `step` [rad] is the bin of the occlusion map.
void markHiddenEdges(Outline& outline, const OcclusionMap& occlusion, const Pose3& T_world_sensor,
                     double margin, double step, double fov);

/// Marks edges as hidden beyond which, within two steps [rad], the lidar does not look; `yaw` [rad]
/// of the sensor in the axes of the field.
void markEdgesOfField(Outline& outline, const LidarField& field, double yaw, double step);

/// z and R of FootprintModel's axes from an outline: noise of the edges (standard deviations [rad,
/// rad, m]) and of the ego pose (J P J', method.md 1.3, which correlates the axes).
void fillFootprint(const Outline& outline, double sigma_left, double sigma_right,
                   double sigma_range, const PoseUncertainty& pose, double sensor_yaw,
                   Measurement& m);

}  // namespace perception
