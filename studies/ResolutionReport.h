#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/StudyReport.h"
#include "libperception/scene/MeasurementRun.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// A sensor set on the log: what its front ends found, and what was tracked.
struct ResolutionRun {
  std::string name;     ///< as in [radecki2016]: C-2k+R
  int resolution = -1;  ///< of its camera, a place in cameraResolutions(); -1: no camera
  bool lidar = false, radar = false;
  MeasurementRun measurements;
  TrackedRun tracks;
};

/// All that the tables of resolutions are made of.
struct ResolutionData {
  std::string source;  ///< of the observations; "simulated ..." where they were
  std::string camera;  ///< label of the panorama's boxes in the runs
  std::string lidar;   ///< label of the lidar that stands in the tables; empty: none
  std::optional<GroundTruth> truth;
  std::vector<ResolutionRun> runs;
  std::vector<std::string> remarks;
};

/// The four tables of the camera in [radecki2016] beside ours, with plots: sizes and ranges; recall
/// and precision, over the range and by its quarters; detections an image; objects tracked.
StudyReport resolutionReport(const ResolutionData& data);

}  // namespace perception
