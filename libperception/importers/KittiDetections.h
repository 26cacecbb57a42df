#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/KittiFiles.h"
#include "libperception/importers/KittiImport.h"

namespace perception {

/// NAME:CLASS=FILE of the command line. Throws Error (kUsage).
KittiImportParams::Detections kittiDetectionsOf(const std::string& text);

/// The boxes of all detectors of a sequence, by frame.
class KittiDetections {
 public:
  /// Reads a file; several files of one name become one detector. Throws Error (kUsage) for a name
  /// without a known layout, DataError.
  void add(const KittiImportParams::Detections& wanted);
  /// An entry a detector, also without any object: that nothing was found is a detection, too.
  void write(std::int64_t frame, Stamp stamp, const KittiCalibration& calibration,
             const Pose3& T_ego_velo, ImportLog& log) const;

 private:
  struct Detector {
    std::string name;
    KittiDetectionLayout layout{};
    std::map<std::int64_t, std::vector<KittiLabel>> by_frame;
  };
  std::vector<Detector> detectors_;
};

}  // namespace perception
