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

/// perception-study resolution: a simulated panorama at 1k, 2k, 4k and 8k.
struct ResolutionOptions {
  ResolutionSite site;
  std::string scenario;  ///< its INI
  double seconds = 40;   ///< of the scenario; 0: all
  std::uint64_t seed = 1;
};

void declareResolution(CLI::App& cli, ResolutionOptions& options);

/// Sensors of all resolutions observe the same world at the same time; each sensor set
/// has its own tracker.
StudyReport resolutionStudy(const ResolutionOptions& options);

}  // namespace perception
