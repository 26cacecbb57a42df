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
  /// [s] an object takes evidence from lanes at most so often (assumed).
  double interval = 1;

  void visit(ParamVisitor& v);
};

/// What lanes say of the wheeled objects on them: pseudo-evidence of the heading's axis, with the
/// variance sigma^2 and once every `interval`, and of front and back, the log-odds of `forward`
/// once for as long as the object keeps to lanes of that direction. A filter without a heading gets
/// the lane's when it stands. Weights of hypotheses are not touched: all of them share the lanes.
class LanePrior {
 public:
  LanePrior(LaneMap map, LaneParams params) : map_(std::move(map)), params_(std::move(params)) {}

  /// Applies to the track at its own time.
  void apply(const FilterModel& model, Track& track) const;

 private:
  bool apply(const FilterModel& model, ClassFilter& filter) const;  ///< whether it took evidence

  LaneMap map_;
  LaneParams params_;
};

}  // namespace perception
