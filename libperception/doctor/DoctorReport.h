#pragma once
#include <string>
#include <vector>

#include "libperception/doctor/LogSurvey.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// One line of the doctor's report.
struct Finding {
  enum class Weight { kFine, kNote, kFault };
  Weight weight = Weight::kFine;
  std::string about;  ///< a label, "poses" ...
  std::string text;
};

/// What the log holds and lacks: sensors, gaps, invalid values, intensity, mounting against the
/// ground, poses; last, which results it cannot give.
std::vector<Finding> findingsOf(const LogSurvey& survey);

/// Plain lines for the terminal.
std::string reportText(const std::vector<Finding>& findings);
/// report.md with the contents of the log, the findings and doctor.png.
StudyReport doctorReport(const LogSurvey& survey, const std::vector<Finding>& findings,
                         const std::string& log);

}  // namespace perception
