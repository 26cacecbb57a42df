#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/LabelsStudy.h"

namespace perception {

/// A way to track.
struct LabelMethod {
  const char* name;
  bool per_class;
  bool takes_unlabeled;  ///< per class: boxes without a label go to every class's tracker
};
inline constexpr LabelMethod kJointTracker = {"joint", false, true};
inline constexpr LabelMethod kTrackerPerClass = {"tracker per class", true, false};
inline constexpr LabelMethod kTrackerPerClassAll = {"tracker per class, unlabeled to all", true,
                                                    true};

/// A row of the study: a damage, a way to track, and how it fared.
struct LabelCondition {
  LabelNoise damage;
  LabelMethod method;
  LabelScore score;  ///< over all logs

  std::string labels() const;  ///< as in the tables
};

/// Tables, pictures and remarks of the study of labels; `where`: its logs, for titles.
void describeLabels(const LabelsParams& params, const std::vector<LabelCondition>& conditions,
                    const std::string& where, StudyReport& report);

/// Adds counts; the figures follow.
void addClear(const ClearFigures& part, ClearFigures& sum);
ClearFigures sumOf(const std::vector<ClearFigures>& parts);
/// Share of the objects with a k-th measurement that then have an output of the right class; of one
/// label, or of all (-1). Empty: there are none.
std::optional<double> rightShare(const LabelScore& score, std::size_t k, int label = -1);
/// [%] as in tables and data of plots.
std::string percent(const std::optional<double>& value);

}  // namespace perception
