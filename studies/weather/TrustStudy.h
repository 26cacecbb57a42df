#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"

namespace CLI {
class App;
}

namespace perception {

/// perception-study trust.
struct TrustOptions {
  std::string log;  ///< rawlog with LOG_Labels/ beside it
  std::string config = "ini/kitti.ini";
  std::vector<std::string> settings;  ///< section.key=value
  double seconds = 0;                 ///< of the log; 0: all
  bool even =
      false;  ///< count frames of even number alone (WADS: [weather.trust] was fitted to odd)
};
void declareTrust(CLI::App& cli, TrustOptions& options);

/// What the pipeline trusts of the lidar's returns, against labels of points. Throws DataError
/// where no scan has labels.
StudyReport trustStudy(const TrustOptions& options);

}  // namespace perception
