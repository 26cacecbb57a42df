#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/paper/PaperRuns.h"

namespace CLI {
class App;
}

namespace perception {

/// perception-study paper. Default: what fits into twenty minutes of two cores.
struct PaperOptions {
  PaperSite site;
  int trials = 5;                      ///< of each scenario in each weather, as in [radecki2016]
  std::vector<std::string> scenarios;  ///< empty: A, B, C
  std::vector<std::string> weathers;   ///< names of paperWeathers(); empty: all
  double resolution_seconds = 15;      ///< of the busy street; 0: the tables stay empty
};
void declarePaper(CLI::App& cli, PaperOptions& options);

/// Every table of [radecki2016] on simulated data, its number beside ours.
StudyReport paperStudy(const PaperOptions& options);

}  // namespace perception
