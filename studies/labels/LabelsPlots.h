#pragma once
#include <string>
#include <vector>

#include "studies/labels/LabelsReport.h"

namespace perception {

/// The metrics over the share of corrupted labels; `where`: names of the logs, for titles.
StudyPlot figuresPlot(const std::vector<LabelCondition>& conditions, const std::string& where);
/// Share of objects with an output of the correct class over the number of their measurements.
StudyPlot curvePlot(const std::vector<LabelCondition>& conditions, const LabelsParams& params,
                    const std::string& where);

}  // namespace perception
