#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/labels/LabelsStudy.h"

namespace perception {

/// Tracking method.
struct LabelMethod {
  const char* name;
  bool per_class;
  bool takes_unlabeled;  ///< per class: boxes without a label go to every class's tracker
};
inline constexpr LabelMethod kJointTracker = {"joint", false, true};
inline constexpr LabelMethod kTrackerPerClass = {"tracker per class", true, false};
inline constexpr LabelMethod kTrackerPerClassAll = {"tracker per class, unlabeled to all", true,
                                                    true};

/// A row of the study: label corruption, tracking method, score.
struct LabelCondition {
  LabelNoise damage;
  LabelMethod method;
  LabelScore score;  ///< over all logs

  std::string labels() const;  ///< as in the tables
};

/// Adds tables, plots and remarks of the study; `where`: names of the logs, for titles.
void describeLabels(const LabelsParams& params, const std::vector<LabelCondition>& conditions,
                    const std::string& where, StudyReport& report);

/// Adds counts and recomputes the metrics.
void addClear(const ClearFigures& part, ClearFigures& sum);
ClearFigures sumOf(const std::vector<ClearFigures>& parts);
/// Share of objects that have an output of the correct class at their k-th measurement; of one
/// label or of all (-1). Empty if there are none.
std::optional<double> rightShare(const LabelScore& score, std::size_t k, int label = -1);
/// [%], formatted for tables and plot data.
std::string percent(const std::optional<double>& value);

}  // namespace perception
