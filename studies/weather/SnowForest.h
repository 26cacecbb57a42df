#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "studies/weather/SnowFeatures.h"

namespace perception {

/// A snow return, recorded or simulated.
struct SnowRow {
  SnowFeatures features{};
  bool real = false;
};

/// Area under the curve of true over false positives: how often a recorded return has a higher
/// score than a simulated one (equal ones count half). 0.5 without rows of both.
double areaUnderCurve(const std::vector<double>& scores, const std::vector<SnowRow>& rows);

/// A random forest (OpenCV's) that tells recorded from simulated snow.
class SnowForest {
 public:
  SnowForest(const std::vector<SnowRow>& rows, std::uint64_t seed);
  ~SnowForest();
  double area(const std::vector<SnowRow>& rows) const;  ///< under its curve on these
  /// By feature: how much the area falls when the feature is permuted among the rows.
  std::vector<double> importance(std::vector<SnowRow> rows, std::uint64_t seed) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace perception
