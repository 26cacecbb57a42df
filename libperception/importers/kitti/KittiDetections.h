#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/kitti/KittiLabels.h"
#include "libperception/importers/street_sets/NuscenesBoxes.h"

namespace perception {

/// The boxes of all detectors of a sequence, by frame.
class KittiDetections {
 public:
  /// Reads a file. `text`: NAME:CLASS=FILE; NAME is the detector's and becomes the sensor label,
  /// CLASS is the type of the rows that are read, or all. Files of the same name are one detector.
  /// Throws Error (kUsage) for other text and for a name without a known layout, DataError. A file
  /// of boxes3d may also be nuScenes' JSON, whose boxes are in the frame of the file of poses.
  void add(const std::string& text);
  /// Boxes that need the vehicle's pose.
  bool needPoses() const;
  /// Writes one observation per detector, also without objects: an empty list is information.
  /// `T_poses_velo`: pose of the Velodyne in the frame of the file of poses; not used unless
  /// needPoses().
  void write(std::int64_t frame, Stamp stamp, const KittiCalibration& calibration,
             const Pose3& T_ego_velo, const Pose3& T_poses_velo, ImportLog& log) const;

 private:
  struct Detector {
    std::string name;
    KittiDetectionLayout layout{};
    std::map<std::int64_t, std::vector<KittiLabel>> by_frame;
    std::map<std::int64_t, std::vector<WorldBox>> in_world;
  };
  std::vector<Detector> detectors_;
};

}  // namespace perception
