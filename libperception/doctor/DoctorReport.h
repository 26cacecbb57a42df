#pragma once
#include <string>
#include <vector>

#include "libperception/doctor/Findings.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Plain lines for the terminal.
std::string reportText(const std::vector<Finding>& findings);
/// report.md with the contents of the log, the findings and doctor.png.
StudyReport doctorReport(const LogSurvey& survey, const std::vector<Finding>& findings,
                         const std::string& log);

}  // namespace perception
