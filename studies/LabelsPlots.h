#pragma once
#include <string>
#include <vector>

#include "studies/LabelsReport.h"

namespace perception {

/// The study's figures over the share of corrupted labels; `where`: its logs, for titles.
StudyPlot figuresPlot(const std::vector<LabelCondition>& conditions, const std::string& where);
/// Objects with an output of the right class, over the number of their measurements.
StudyPlot curvePlot(const std::vector<LabelCondition>& conditions, const LabelsParams& params,
                    const std::string& where);

}  // namespace perception
