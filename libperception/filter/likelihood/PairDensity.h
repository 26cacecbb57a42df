#pragma once
#include <array>
#include <limits>
#include <vector>

#include "libperception/core/LogMath.h"
#include "libperception/filter/likelihood/Innovation.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// Indices of the axes that a measurement has seen.
struct AxisList {
  std::array<Eigen::Index, kMaxAxes> index{};
  int count = 0;

  AxisList(const Measurement& m, std::size_t axes) {
    for (std::size_t i = 0; i < axes; ++i)
      if (m.seen >> i & 1) index[static_cast<std::size_t>(count++)] = static_cast<Eigen::Index>(i);
  }
};

/// Log density of an innovation and its normalized square; of modes their mixture and the least.
/// -inf and infinite where S is no covariance.
struct Density {
  double log_density = kMinusInfinity;
  double nis = std::numeric_limits<double>::infinity();
};

Density densityOf(const Innovation& innovation, const ClassFilter& filter);

/// What a filter of one Gaussian expects of all axes, made once for all measurements that may be
/// near: densityOf() of their innovations at a fraction of the cost.
class ExpectedAxes {
 public:
  void set(const ClassFilter& f, const Kinematics& k, const AxisPrediction& p);
  /// Of a measurement with these `axes`; `p` is the prediction that it was set by.
  Density densityOf(const AxisPrediction& p, const Measurement& m, const AxisList& axes,
                    const std::vector<AxisKind>& kinds) const;

 private:
  AxisMatrix S_;  ///< H P H' and the model's own noise; that of the measurement comes on top
};

}  // namespace perception
