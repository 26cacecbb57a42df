#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Writes report.md, the tables as CSV, further files, and the plots with their scripts and data
/// into the folder `output`; complete or not at all. Returns warnings about missing plots. Throws
/// OutputError.
std::vector<std::string> writeStudyReport(const StudyReport& report, const std::string& output);

}  // namespace perception
