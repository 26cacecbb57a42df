#pragma once
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// One point of a radar file; SI units, rcs in dBsm.
struct VodRadarPoint {
  float x, y, z, rcs, rate, rate_compensated, time;
};
static_assert(sizeof(VodRadarPoint) == 28, "7 float32 a point");

/// Throws DataError.
std::vector<VodRadarPoint> readVodRadar(const std::string& path);

/// `still`: static scene with the vehicle at rest, so range rates are the compensated ones.
RadarReturns returnsOf(const std::vector<VodRadarPoint>& points, bool still);

/// [m/s] Velocity of the radar in its own frame, by least squares from v_r - v_r_compensated = -(u,
/// velocity).
Vector2 ownVelocity(const std::vector<VodRadarPoint>& points);

/// odomToCamera of a pose file (one JSON object a line): the camera's pose in the odometry's frame.
/// Throws DataError.
Pose3 readVodPose(const std::string& path);

}  // namespace perception
