#pragma once
#include <string>
#include <vector>

#include "libperception/doctor/LogSurvey.h"

namespace perception {

/// One line of the doctor's report.
struct Finding {
  enum class Weight { kFine, kNote, kFault };
  Weight weight = Weight::kFine;
  std::string about;  ///< a label, "poses" ...
  std::string text;
};

/// Findings in the order in which the report lists them.
struct Findings {
  std::vector<Finding> all;
  void add(Finding::Weight weight, const std::string& about, const std::string& text);
};

/// What the log holds and lacks: sensors, gaps, invalid values, intensity, mounting against the
/// ground, poses; last, which results it cannot give.
std::vector<Finding> findingsOf(const LogSurvey& survey);

}  // namespace perception
