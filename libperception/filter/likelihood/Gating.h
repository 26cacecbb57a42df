#pragma once
#include <array>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// Chi-square quantiles of one probability by number of axes.
struct Gates {
  explicit Gates(double probability);
  /// Those of the probability asked for last: a run has one.
  static const Gates& of(double probability);
  std::array<double, kMaxAxes + 1> quantile{};
};

/// A disc about one class filter that holds the centers of all that are kept up to date.
struct BoundingDisc {
  Vector2 center = Vector2::Zero();  ///< [m] world
  double spread = 0;                 ///< [m] radius
  double size = 0;                   ///< [m] half of the largest side
  double reach = 0;  ///< [m] of the coarse gate, the measurement's own deviation left out
  explicit BoundingDisc(const Track& track);
  /// False when no class filter can be coarsely near: most pairs end here.
  bool mayBeNear(const Measurement& m) const;
};

/// Before any matrix: false for pairs that are too far apart to pass the gate.
bool coarseGate(const Track& track, const Measurement& m);

/// Bounds from below the NIS of one class filter by its axes one by one: y' S^-1 y >= y_a^2 / S_aa.
/// Most pairs that are coarsely near fail here, at a few products each.
class AxisBounds {
 public:
  AxisBounds(const ClassFilter& filter, const Kinematics& k, const AxisPrediction& prediction);
  /// True only if the NIS is beyond `gate`; `kinds` are the model's axes.
  bool exclude(const Measurement& m, const std::vector<AxisKind>& kinds, double gate) const;

 private:
  const AxisPrediction& prediction_;
  bool applies_;  // of motion modes any may be the nearest
  std::array<double, kMaxAxes> variance_{};
};

/// Where a sensor may see the track: P_D is taken at the means of the class filters.
ReachableDisc reachableDiscOf(const Track& track, const FilterModel& model);

/// A track that no scan concerns is left behind until one does, or until it has expired; at most
/// for this long [s]. Its steps are taken when it wakes, and most never do.
inline constexpr double kLongestDeferral = 60;
/// The same of tracks with motion modes: those mix once a step, and the step may not be long.
inline constexpr double kLongestDeferralOfModes = 0.5;

/// Whether the scan's sensor sees places alone: whatever size a track has, only where it is counts.
bool isPositionOnly(const MeasurementScan& scan);
/// False when the scan can say nothing of the track, since all its class filters, predicted, are
/// out of view: it stays as it is for now. `position_only`: isPositionOnly().
bool mayBeInView(const MeasurementScan& scan, const Track& track, bool position_only);
inline bool mayBeInView(const MeasurementScan& scan, const Track& track) {
  return mayBeInView(scan, track, isPositionOnly(scan));
}

}  // namespace perception
