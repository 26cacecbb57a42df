#pragma once
#include <string>

#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Plots of the person filter as in [radecki2016]: the kernel over the radius in both
/// interpretations, and its response to the first lidar scan of a rawlog, or, without one, to
/// simulated returns of a person, a wall, a car and a pole. Throws DataError when the log has no
/// scan.
StudyReport personFilterStudy(const std::string& log);

}  // namespace perception
