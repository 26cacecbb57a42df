#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/front_ends/FrontEndEvaluation.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Kinds of objects: 0 car, 1 person.
inline constexpr int kResolutionKinds = 2;
/// Labels of measurements that name a kind.
using KindLabels = std::array<std::vector<std::string>, kResolutionKinds>;

/// part / whole; empty if whole is 0.
std::optional<double> shareOf(std::size_t part, std::size_t whole);

/// Recall by distance of the center in tenths of the sensor's range for the kind, and precision.
struct RangeRates {
  static constexpr int kBins = 10, kLastBin = 16;  ///< to the range; to 1.6 times the range

  std::array<double, kResolutionKinds> range{1, 1};  ///< [m]
  std::array<std::array<RecallCounts, kLastBin>, kResolutionKinds> recall;
  std::array<PrecisionCounts, kResolutionKinds> precision;

  /// Sum over distances in [from, to), as shares of the range, multiples of .1.
  RecallCounts within(int kind, double from, double to) const;
  /// Share detected with the correct label; empty if none in view.
  std::optional<double> recallIn(int kind, double from, double to) const;
  /// [m] distance at which recall falls to half of its mean over the nearer half of the range
  /// (without objects there, over the rest).
  std::optional<double> halfRange(int kind) const;
};
/// Unoccluded objects only.
RangeRates rangeRates(const MeasurementRun& run, const std::string& sensor,
                      const GroundTruth& truth, std::array<double, kResolutionKinds> range,
                      const KindLabels& labels);

/// Number of measurements of a sensor, all and by kind.
struct DetectionCounts {
  double scans = 0, all = 0;
  std::array<std::vector<double>, kResolutionKinds> ranges;  ///< [m] of each measurement

  double mean() const { return scans > 0 ? all / scans : 0; }
  double mean(int kind) const;
  /// [m] 95 % quantile of the ranges.
  std::optional<double> reach(int kind) const;
};
DetectionCounts detectionCounts(const MeasurementRun& run, const std::string& sensor,
                                const KindLabels& labels);

/// Mean number of objects per scene: all, and those classified as car and as pedestrian.
struct TrackedCounts {
  double all = 0;
  std::array<double, kResolutionKinds> kind{0, 0};
};
TrackedCounts trackedCounts(const TrackedRun& run);

}  // namespace perception
