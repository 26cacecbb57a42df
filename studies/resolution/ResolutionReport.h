#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/scene/files/MeasurementRun.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Measurements and tracks of one sensor set on the log.
struct ResolutionRun {
  std::string name;     ///< as in [radecki2016]: C-2k+R
  int resolution = -1;  ///< of its camera, a place in cameraResolutions(); -1: no camera
  bool lidar = false, radar = false;
  MeasurementRun measurements;
  TrackedRun tracks;
};

/// Input of the report.
struct ResolutionData {
  std::string source;  ///< of the observations; begins with "simulated" if they are
  std::string camera;  ///< label of the panorama's boxes in the runs
  std::string lidar;   ///< label of the lidar in the tables; empty: none
  std::optional<GroundTruth> truth;
  std::vector<ResolutionRun> runs;
  std::vector<std::string> remarks;
};

/// The four camera tables of [radecki2016] compared with the data, with plots: sizes and ranges;
/// recall and precision, over the range and by its quarters; detections per image; objects tracked.
StudyReport resolutionReport(const ResolutionData& data);

}  // namespace perception
