#pragma once
#include <map>
#include <string>
#include <vector>

#include "libperception/calibration/detectors/DetectorCounts.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/measurement/models/DetectionModel.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Inputs of the study besides the counts.
struct DetectorStudyInput {
  ClassTable classes;
  std::map<std::string, std::vector<std::string>> labels;  ///< of each sensor, by its name
  std::string logs;                                        ///< names of what was read
  bool simulated = false;
  std::map<std::string, DetectionParams> stated;  ///< what the INI says of each sensor
  std::string include;  ///< INI that `gains.ini` goes beyond; empty: none is written
};

/// Counted P_D, label tables, clutter, births and noise of every sensor compared with the INI, and
/// `detector.ini`: the counted keys as INI sections with their counts as comments. With `include`,
/// `gains.ini` instead: the keys whose 90 % interval does not hold the INI's value
/// (method.md 8.15).
StudyReport detectorStudy(const DetectorStudyInput& input,
                          const std::map<std::string, DetectorCounts>& counts);

}  // namespace perception
