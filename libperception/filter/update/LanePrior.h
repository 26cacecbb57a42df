#pragma once
#include <string>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/core/LaneMap.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// [lanes]: a map of lanes as a prior of headings (method.md 5.16).
struct LaneParams {
  std::string file;  ///< FILE.lanes.csv; empty: no prior
  /// [rad] spread of headings about the lane's direction (method.md 5.16; assumed)
  double sigma = radians(10);
  /// Share of wheeled objects that face the driving direction (assumed).
  double forward = 0.95;
  /// [s] shortest time between two lane updates of an object (assumed).
  double interval = 1;

  void visit(ParamVisitor& v);
};

/// Pseudo-measurement of the heading of wheeled objects on a lane: of the axis with variance
/// sigma^2 every `interval`, and of front/back with the log-odds of `forward`, once while the
/// object stays on lanes of that direction. A stationary filter without heading takes the lane's.
/// Weights of hypotheses do not change.
class LanePrior {
 public:
  LanePrior(LaneMap map, LaneParams params) : map_(std::move(map)), params_(std::move(params)) {}

  /// Updates the track at its own stamp.
  void apply(const FilterModel& model, Track& track) const;

 private:
  bool apply(const FilterModel& model, ClassFilter& filter) const;  ///< true if it was updated

  LaneMap map_;
  LaneParams params_;
};

}  // namespace perception
