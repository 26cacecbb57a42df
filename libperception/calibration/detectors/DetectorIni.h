#pragma once
#include <string>
#include <vector>

#include "libperception/calibration/detectors/DetectorCounts.h"
#include "libperception/calibration/detectors/DetectorStudy.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// The counted keys of a sensor as sections of an INI, with the counts as comments.
std::string detectorIni(const DetectorCounts& counts, const ClassTable& classes,
                        const std::vector<std::string>& labels);

/// The keys whose interval does not hold the INI's value, as sections of an INI; a row of `table`
/// for every key, written or kept (method.md 8.15).
std::string gainsIni(const DetectorCounts& counts, const DetectorStudyInput& input,
                     StudyTable& table);

}  // namespace perception
