#pragma once
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// How scans become frames of one lidar: in [sensor.LABEL], kind = lidar.
struct ScanParams {
  enum class Ground {
    kNo,
    kYes,  ///< where the sensor is in use
    kOnly  ///< and nothing else: also where the sensor is not in use, no measurements
  };
  std::vector<std::string> merge;  ///< labels of the scanners that are one sensor; empty: its own
  double merge_window =
      0.05;  ///< [s] from the first scan to the last one of a merged frame (assumed)
  Ground ground = Ground::kYes;  ///< is the road estimated from its returns? (method.md 8.1)

  void visit(ParamVisitor& v);
  /// Does an observation of that label belong to the merged sensor? A trailing * stands for any
  /// end: IBEO_LEFT_L* are the layers of a scanner that come as planar scans.
  bool merges(const std::string& label) const;
};

/// Scans of several scanners, or of the layers of one, as one scan: points in the frame of the
/// first one, stamped as the newest, each point's time with it. Rings of one scanner follow those
/// of the scanner before. `frames` is not empty and holds point clouds; its order is that of the
/// rings.
SensorFrame mergedScan(const std::vector<SensorFrame>& frames, const std::string& label);

}  // namespace perception
