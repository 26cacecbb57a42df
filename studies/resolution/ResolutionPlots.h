#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/models/CameraResolution.h"
#include "studies/resolution/ResolutionFigures.h"
#include "studies/resolution/ResolutionReport.h"

namespace perception {

/// Results of one camera run for tables and plots.
struct CameraFigures {
  const ResolutionRun* run;
  DetectionCounts detections;
  std::optional<RangeRates> rates;
};

/// Table row of a run's camera.
const CameraResolution& rowOf(const ResolutionRun& run);
/// [m] range of a row for a kind: 0 car, 1 person.
double rangeOf(const CameraResolution& row, int kind);

/// Recall over range, one curve per resolution; `where`: names of the logs, for titles.
StudyPlot recallPlot(const std::vector<CameraFigures>& cameras, const std::string& where);
/// A table of rates and that of [radecki2016], side by side.
StudyPlot ratePlot(const StudyTable& table, const std::string& what, const std::string& where);

}  // namespace perception
