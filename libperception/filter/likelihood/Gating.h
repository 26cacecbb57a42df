#pragma once
#include <array>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// Chi-square quantiles of one gate probability by number of axes.
struct Gates {
  explicit Gates(double probability);
  /// Cached for the last probability, since a run uses one.
  static const Gates& of(double probability);
  std::array<double, kMaxAxes + 1> quantile{};
};

/// A disc that contains the means of all live class filters of a track, for the coarse gate.
struct BoundingDisc {
  Vector2 center = Vector2::Zero();  ///< [m] world
  double spread = 0;                 ///< [m] radius
  double size = 0;                   ///< [m] half of the longest side of the class filters' extents
  double reach = 0;  ///< [m] radius of the coarse gate without the measurement's standard deviation
  explicit BoundingDisc(const Track& track);
  /// False when no class filter can pass the coarse gate: rejects most pairs.
  bool mayBeNear(const Measurement& m) const;
};

/// Distance test without matrices: false for pairs that cannot pass the gate.
bool coarseGate(const Track& track, const Measurement& m);

/// Lower bound of the NIS of one class filter from single axes: y' S^-1 y >= y_a^2 / S_aa. Rejects
/// most pairs that pass the coarse gate at the cost of a few products.
class AxisBounds {
 public:
  AxisBounds(const ClassFilter& filter, const Kinematics& k, const AxisPrediction& prediction);
  /// True only if the NIS is beyond `gate`; `kinds` are the model's axes.
  bool exclude(const Measurement& m, const std::vector<AxisKind>& kinds, double gate) const;

 private:
  const AxisPrediction& prediction_;
  bool applies_;  // false with motion modes: any of them may have the smallest NIS
  std::array<double, kMaxAxes> variance_{};
};

/// Bounds where a sensor may see the track; P_D is evaluated at the means of the class filters.
ReachableDisc reachableDiscOf(const Track& track, const FilterModel& model);

/// [s] Longest deferred prediction of a track that is out of view of all scans: it is predicted
/// when a sensor may see it again, or dropped when its existence has decayed, which is the usual
/// case.
inline constexpr double kLongestDeferral = 60;
/// [s] The same for tracks with motion modes, which mix once per prediction step.
inline constexpr double kLongestDeferralOfModes = 0.5;

/// Whether the scan's measurement model is a PositionOnlyModel: visibility then depends on the
/// center alone, not on the extent.
bool isPositionOnly(const MeasurementScan& scan);
/// False when all predicted class filters of the track are out of the sensor's view, so that its
/// prediction can be deferred. `position_only`: isPositionOnly(scan).
bool mayBeInView(const MeasurementScan& scan, const Track& track, bool position_only);
inline bool mayBeInView(const MeasurementScan& scan, const Track& track) {
  return mayBeInView(scan, track, isPositionOnly(scan));
}

}  // namespace perception
