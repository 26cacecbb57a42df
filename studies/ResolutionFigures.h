#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/FrontEndEvaluation.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// Figures by kind of object: 0 car, 1 person.
inline constexpr int kResolutionKinds = 2;
/// Labels of measurements that name a kind.
using KindLabels = std::array<std::vector<std::string>, kResolutionKinds>;

/// A part of a whole; empty: no whole.
std::optional<double> shareOf(std::size_t part, std::size_t whole);

/// Recall in tenths of a sensor's range for the kind (distance of the center), and precision.
struct RangeRates {
  static constexpr int kBins = 10, kLastBin = 16;  ///< to the range; to 1.6 times the range

  std::array<double, kResolutionKinds> range{1, 1};  ///< [m]
  std::array<std::array<RecallCounts, kLastBin>, kResolutionKinds> recall;
  std::array<PrecisionCounts, kResolutionKinds> precision;

  /// Sum over [from, to), shares of the range in tenths.
  RecallCounts within(int kind, double from, double to) const;
  /// Found and rightly named; empty: none in view.
  std::optional<double> recallIn(int kind, double from, double to) const;
  /// [m] where recall falls through half of what it is in the nearer half of the range
  /// (where nothing stands there, in the rest of it).
  std::optional<double> halfRange(int kind) const;
};
/// Of what stands free alone: how a detector fares with things half hidden is another question.
RangeRates rangeRates(const MeasurementRun& run, const std::string& sensor,
                      const GroundTruth& truth, std::array<double, kResolutionKinds> range,
                      const KindLabels& labels);

/// Measurements of a sensor: all and by kind.
struct DetectionCounts {
  double scans = 0, all = 0;
  std::array<std::vector<double>, kResolutionKinds> ranges;  ///< [m] of each measurement

  double mean() const { return scans > 0 ? all / scans : 0; }
  double mean(int kind) const;
  /// [m] within which 95 % of them lie.
  std::optional<double> reach(int kind) const;
};
DetectionCounts detectionCounts(const MeasurementRun& run, const std::string& sensor,
                                const KindLabels& labels);

/// Objects output a scene: all, and those that are a car or a pedestrian with 95 %.
struct TrackedCounts {
  double all = 0;
  std::array<double, kResolutionKinds> kind{0, 0};
};
TrackedCounts trackedCounts(const TrackedRun& run);

}  // namespace perception
