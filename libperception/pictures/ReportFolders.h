#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/Report.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Writes report.md, the tables as CSV, further files, and the plots with their scripts and data
/// into the folder `output`; complete or not at all. Returns warnings about missing plots. Throws
/// OutputError.
std::vector<std::string> writeStudyReport(const StudyReport& report, const std::string& output);

/// Writes a report of every run into its folder evaluation/, or below `output` where that is given,
/// and there a joint one of several runs or of conditions. `plots`: most truth objects with a plot
/// of their own, for each run; empty: tables only. `warn` is told of missing plots. Returns the
/// folders. Throws Error (kUsage) for conditions without `output`, OutputError.
std::vector<std::string> writeEvaluations(const EvaluationReport& report, const std::string& output,
                                          std::optional<std::size_t> plots,
                                          const std::function<void(const std::string&)>& warn);

}  // namespace perception
