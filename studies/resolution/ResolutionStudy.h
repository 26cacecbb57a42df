#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "studies/resolution/ResolutionReport.h"
#include "studies/resolution/ResolutionStreams.h"

namespace CLI {
class App;
}

namespace perception {

/// perception-study resolution: a panorama at 1k, 2k, 4k and 8k, simulated or of a log.
struct ResolutionOptions {
  ResolutionSite site;
  std::string scenario;  ///< simulated: scenario INI
  std::string log;       ///< else a rawlog with images
  std::string images;    ///< sensorLabel of its images; empty: the first
  std::string detector;  ///< INI of perception-detect, for the log
  std::string truth;     ///< of the log; empty: LOG.truth.csv where it is
  double seconds = 40;   ///< of scenario or log; 0: all
  std::uint64_t seed = 1;
};

void declareResolution(CLI::App& cli, ResolutionOptions& options);

/// Sensors of all resolutions observe the same world (or image) at the same time; each sensor set
/// has its own tracker.
StudyReport resolutionStudy(const ResolutionOptions& options);

}  // namespace perception
