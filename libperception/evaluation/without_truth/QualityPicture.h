#pragma once
#include <array>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/evaluation/without_truth/Quality.h"

namespace perception {

/// Where and when a person should look: the ways of all objects from above with the moments of
/// `quality`, and the number of those of named classes over time with the same.
StudyPlot momentsPicture(const TrackedRun& run, const Quality& quality,
                         const QualityOptions& options);

/// Figures and true errors of one run.
struct FiguresAndErrors {
  std::vector<Figure> values;
  std::array<Figure, kTrueErrors> errors;
};
/// Each figure that is shown to users over the true error that it follows, a point a run.
StudyPlot followingPicture(const std::vector<FiguresAndErrors>& runs);

}  // namespace perception
