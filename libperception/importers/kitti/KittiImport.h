#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/kitti/KittiFiles.h"

namespace perception {

/// Inputs of a KITTI tracking sequence.
struct KittiImportParams {
  std::string calibration;               ///< calibration file
  std::string poses;                     ///< ego motion, one line per frame ...
  std::string poses_frame = "velodyne";  ///< ... of velodyne, camera or imu
  std::string poses_format = "kitti";    ///< ... kitti or tum
  std::string oxts;                      ///< instead of poses
  std::string lidar_dir, images_dir;     ///< empty: none
  std::string labels;                    ///< truth; empty: none
  struct Detections {
    std::string name;        ///< detector; becomes the sensor label
    std::string class_name;  ///< rows of this type, or all
    std::string file;
  };
  std::vector<Detections> detections;
};

/// [m] Height of the Velodyne on KITTI's car (Geiger et al., IJRR 2013, figure 3).
inline constexpr double kKittiVelodyneHeight = 1.73;

/// Pose of the Velodyne above the ground for single frames without poses. The cameras are taken as
/// level (KITTI's page on the sensor setup), so that image boxes agree with the ground plane; the
/// Velodyne is pitched down by half a degree (in its scans the road rises by .7 to 1.2 % ahead, in
/// labels in the camera frame by .1 %).
Pose3 levelVelodyne(const KittiCalibration& calibration);

/// Writes FILE.rawlog and, with labels, FILE.truth.csv, frame by frame (bounded memory). World: the
/// ego frame at line 0 of the poses, 1.73 m under the Velodyne. Throws Error (kUsage), DataError,
/// OutputError.
ImportResult importKitti(const KittiImportParams& params, ImportOptions options,
                         const ImportProgress& progress = {});

/// Converts a label to a truth row without stamp and velocity. `cloud`: in the Velodyne frame.
TruthObject truthOf(const KittiLabel& label, const KittiCalibration& calibration,
                    const Pose3& T_world_velo, const std::optional<LidarCloud>& cloud);

}  // namespace perception
