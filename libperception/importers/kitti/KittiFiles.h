#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A drive's calibration file. Names: velo = Velodyne (x forward, y left, z up), cam0 = rectified
/// left gray camera (x right, y down, z forward), cam2 = left color camera, imu = GPS/IMU body (x
/// forward, y left, z up).
struct KittiCalibration {
  Pose3 T_cam0_velo = Pose3::Identity();  ///< R0_rect * Tr_velo_to_cam
  std::optional<Pose3> T_velo_imu;        ///< Tr_imu_to_velo, when the file has it
  Pose3 T_cam0_cam2 = Pose3::Identity();  ///< from P2 = K [I | t]
  CameraModel camera;                     ///< of cam2
};

/// [m] Height of the Velodyne on KITTI's car (Geiger et al., IJRR 2013, figure 3).
inline constexpr double kKittiVelodyneHeight = 1.73;

// All readers throw DataError: kNoInput when the file is missing, else with file, line and what was
// expected.

/// Camera and place of the left color camera, by its projection from cam0; the size of its images
/// follows from the focal length. False: it is not K [I | t].
bool setKittiCamera(const Eigen::Matrix<double, 3, 4>& P2, KittiCalibration& calibration);

KittiCalibration readKittiCalibration(const std::string& path);

/// Pose of the Velodyne above the ground for single frames without poses. The cameras are taken as
/// level (KITTI's page on the sensor setup), so that image boxes agree with the ground plane; the
/// Velodyne is pitched down by half a degree (in its scans the road rises by .7 to 1.2 % ahead, in
/// labels in the camera frame by .1 %).
Pose3 levelVelodyne(const KittiCalibration& calibration);

/// Poses in the frame of the first line, one line a frame: 12 numbers row-major (kitti), or t x y z
/// qx qy qz qw (tum; t is not used: line k is frame k).
std::vector<Pose3> readKittiPoses(const std::string& path, const std::string& format);
/// Poses of the GPS/IMU body in the local Mercator plane of the KITTI development kit, from an oxts
/// file.
std::vector<Pose3> readKittiOxts(const std::string& path);
/// The same of files with a line each, as in the raw data.
std::vector<Pose3> readKittiOxts(const std::vector<std::string>& paths);

/// One Velodyne scan, .bin or .bin.gz: little-endian float32 x, y, z, intensity [m, 0 to 1].
LidarCloud readKittiScan(const std::string& path);

}  // namespace perception
