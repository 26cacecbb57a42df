#pragma once
#include "libperception/doctor/LogSurvey.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// doctor.png: stamps of every label over time, one scan from above and from the side with the
/// ground found, and what the poses say of speed and yaw rate.
StudyPlot doctorPicture(const LogSurvey& survey);

}  // namespace perception
