#pragma once
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Range [m] of what each pixel of a recorded image shows, rows from the top (method.md 9.14): from
/// lidar returns [m, world] where they are dense enough, filled between neighbors; elsewhere the
/// flat road at height 0 below the horizon, above it CameraView::kSky where `sky` (one per pixel)
/// is set, else the range of the uppermost return in that direction.
std::vector<float> imageRanges(const CameraModel& camera, const Pose3& T_world_camera,
                               const std::vector<Vector3>& returns, const std::vector<char>& sky);

/// Moves the edges of `ranges` to those of the image (gray values in [0, 1]) by a guided filter
/// [he2013] of their inverse.
void alignRanges(const CameraModel& camera, const std::vector<float>& gray,
                 std::vector<float>& ranges);

}  // namespace perception
