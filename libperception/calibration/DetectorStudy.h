#pragma once
#include <map>
#include <string>
#include <vector>

#include "libperception/calibration/DetectorCounts.h"
#include "libperception/evaluation/StudyReport.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// What is known of the detectors before anything is counted.
struct DetectorStudyInput {
  ClassTable classes;
  std::map<std::string, std::vector<std::string>> labels;  ///< of each sensor, by its name
  std::string logs;                                        ///< names of what was read
  bool simulated = false;
};

/// Detection, labels, clutter, births and noise of every sensor beside what the INI says, and
/// `detector.ini`: the counted keys as sections for the vehicle's INI, their counts as comments.
StudyReport detectorStudy(const DetectorStudyInput& input,
                          const std::map<std::string, DetectorCounts>& counts);

}  // namespace perception
