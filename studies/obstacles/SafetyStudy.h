#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"

namespace CLI {
class App;
}

namespace perception {

/// perception-study safety.
struct SafetyOptions {
  std::vector<std::string> logs;  ///< rawlogs with LOG_Labels/ beside them
  std::string config = "ini/kitti.ini";
  std::vector<std::string> settings;  ///< section.key=value
  double seconds = 0;                 ///< of each log; 0: all
};
void declareSafety(CLI::App& cli, SafetyOptions& options);

/// False and missed stops for what is in the driven path, and tracks that stand on phantoms, by the
/// labels of the returns: by plain Euclidean clusters, by the safety grid without trust, and
/// by the run's own advice.
/// Throws DataError where no scan has labels.
StudyReport safetyStudy(const SafetyOptions& options, unsigned long long seed);

}  // namespace perception
