#pragma once

namespace perception {

/// Sensor labels that importers give to the sensors of recordings; the site INIs name them.
inline constexpr const char *kLidarTop = "LIDAR_TOP", *kRadarTop = "RADAR_TOP",
                            *kRadarFront = "RADAR_FRONT", *kCameraFront = "CAMERA_FRONT",
                            *kCameraLeft = "CAMERA_LEFT";

}  // namespace perception
