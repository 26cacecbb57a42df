#pragma once
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Merging of scans into frames of one lidar: part of [sensor.LABEL], kind = lidar.
struct ScanParams {
  enum class Ground {
    kNo,
    kYes,  ///< if the sensor is in use
    kOnly  ///< also if the sensor is not in use; no measurements
  };
  std::vector<std::string> merge;  ///< labels of the scanners that form one sensor; empty: its own
  double merge_window =
      0.05;  ///< [s] from the first scan to the last one of a merged frame (assumed)
  Ground ground = Ground::kYes;  ///< ground plane from its returns (method.md 8.1)

  void visit(ParamVisitor& v);
  /// Whether an observation of that label is part of the merged sensor. A trailing * is a wildcard:
  /// IBEO_LEFT_L* are the layers of a scanner recorded as planar scans.
  bool merges(const std::string& label) const;
};

/// Merges scans of several scanners, or of the layers of one: points in the sensor frame of the
/// first, with the stamp of the latest and time offsets relative to it. Rings are numbered
/// consecutively in the order of `frames`, which must not be empty and hold point clouds.
SensorFrame mergedScan(const std::vector<SensorFrame>& frames, const std::string& label);

}  // namespace perception
