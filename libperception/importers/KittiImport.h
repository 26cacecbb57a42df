#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/KittiFiles.h"

namespace perception {

/// What is imported from a KITTI tracking sequence, beside ImportOptions.
struct KittiImportParams {
  std::string calibration;               ///< calibration file
  std::string poses;                     ///< ego motion, one line a frame ...
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

/// The Velodyne over the ground of a still frame, where the ground holds what an image box says:
/// the cameras are level with it (KITTI's page on the sensor setup), and the Velodyne looks down by
/// half a degree (its scans see the road rise by .7 to 1.2 % ahead, labels of the tracking
/// sequences, in the cameras' frame, by .1 %).
Pose3 levelVelodyne(const KittiCalibration& calibration);

/// Writes FILE.rawlog and, with labels, FILE.truth.csv; frame by frame, so memory does not grow
/// with the sequence. World: the ego frame at line 0 of the poses, 1.73 m under the Velodyne.
/// Throws Error (kUsage), DataError, OutputError.
ImportResult importKitti(const KittiImportParams& params, ImportOptions options,
                         const ImportProgress& progress = {});

/// A label as a row of the truth, stamp and velocity aside. `cloud`: in the Velodyne frame.
TruthObject truthOf(const KittiLabel& label, const KittiCalibration& calibration,
                    const Pose3& T_world_velo, const std::optional<LidarCloud>& cloud);

}  // namespace perception
