#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/importers/kitti/KittiFiles.h"

namespace perception {

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

/// The box in the Velodyne frame: bottom center and heading of the length axis.
ObjectDetection::SpaceBox boxInVelodyne(const KittiBox& box, const KittiCalibration& calibration);

/// Number of returns (Velodyne frame) inside the box.
int returnsInside(const KittiBox& box, const LidarCloud& cloud,
                  const KittiCalibration& calibration);

/// Converts a label to a truth row without stamp and velocity. `cloud`: in the Velodyne frame.
TruthObject truthOf(const KittiLabel& label, const KittiCalibration& calibration,
                    const Pose3& T_world_velo, const std::optional<LidarCloud>& cloud);

}  // namespace perception
