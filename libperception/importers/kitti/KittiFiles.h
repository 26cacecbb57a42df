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

/// A 3D box as KITTI writes it, in cam0; all NaN for an image area (DontCare).
struct KittiBox {
  double height = 0, width = 0, length = 0;  ///< [m]
  Vector3 bottom_center = Vector3::Zero();   ///< [m] cam0
  double rotation_y = 0;  ///< [rad] about the camera's y axis; 0 = length axis along x
};

/// One line of a tracking label file.
struct KittiLabel {
  std::int64_t frame = 0, id = -1;
  std::string type;
  double truncated = 0;
  int occluded = 0;
  double alpha = 0;  ///< [rad] observation angle
  ObjectDetection::ImageBox image_box;
  std::optional<KittiBox> box;
  double score = 1;  ///< if from a detector
};

// All readers throw DataError: kNoInput when the file is missing, else with file, line and what was
// expected.

/// Camera and place of the left color camera, by its projection from cam0; the size of its images
/// follows from the focal length. False: it is not K [I | t].
bool setKittiCamera(const Eigen::Matrix<double, 3, 4>& P2, KittiCalibration& calibration);

KittiCalibration readKittiCalibration(const std::string& path);

/// Poses in the frame of the first line, one line a frame: 12 numbers row-major (kitti), or t x y z
/// qx qy qz qw (tum; t is not used: line k is frame k).
std::vector<Pose3> readKittiPoses(const std::string& path, const std::string& format);
/// Poses of the GPS/IMU body in the local Mercator plane of the KITTI development kit, from an oxts
/// file.
std::vector<Pose3> readKittiOxts(const std::string& path);
/// The same of files with a line each, as in the raw data.
std::vector<Pose3> readKittiOxts(const std::vector<std::string>& paths);

/// Truth, or detections in the same layout (last column score, column of ids optional).
std::vector<KittiLabel> readKittiLabels(const std::string& path);

/// Truth of one frame in the layout of the object benchmark: without frame and id columns (ids are
/// line numbers).
std::vector<KittiLabel> readKittiObjectLabels(const std::string& path, std::int64_t frame);

/// Detections of one file, by frame. Rows whose type is not `class_name` are skipped unless
/// `class_name` is "all". Layouts: see kittiDetectionLayouts().
std::vector<KittiLabel> readKittiDetections(const std::string& path, const std::string& layout,
                                            const std::string& class_name);

/// File layout of a detector.
struct KittiDetectionLayout {
  const char* name;
  bool space_boxes;  ///< 3D boxes (modality L), otherwise image boxes (modality C)
  bool has_alpha;    ///< the observation angle is valid
};
const std::vector<KittiDetectionLayout>& kittiDetectionLayouts();

/// One Velodyne scan, .bin or .bin.gz: little-endian float32 x, y, z, intensity [m, 0 to 1].
LidarCloud readKittiScan(const std::string& path);

/// The box in the Velodyne frame: bottom center and heading of the length axis.
ObjectDetection::SpaceBox boxInVelodyne(const KittiBox& box, const KittiCalibration& calibration);

/// Number of returns (Velodyne frame) inside the box.
int returnsInside(const KittiBox& box, const LidarCloud& cloud,
                  const KittiCalibration& calibration);

}  // namespace perception
