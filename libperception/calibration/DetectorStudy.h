#pragma once
#include <map>
#include <string>
#include <vector>

#include "libperception/calibration/DetectorCounts.h"
#include "libperception/evaluation/StudyReport.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// Inputs of the study besides the counts.
struct DetectorStudyInput {
  ClassTable classes;
  std::map<std::string, std::vector<std::string>> labels;  ///< of each sensor, by its name
  std::string logs;                                        ///< names of what was read
  bool simulated = false;
};

/// Counted P_D, label tables, clutter, births and noise of every sensor compared with the INI, and
/// `detector.ini`: the counted keys as INI sections with their counts as comments.
StudyReport detectorStudy(const DetectorStudyInput& input,
                          const std::map<std::string, DetectorCounts>& counts);

}  // namespace perception
