#pragma once
#include <array>
#include <limits>
#include <vector>

#include "libperception/core/math/LogMath.h"
#include "libperception/filter/likelihood/Innovation.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

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

/// Log density and NIS of an innovation; with motion modes, log density of the mixture and smallest
/// NIS. -inf and infinity where S is not positive definite.
struct Density {
  double log_density = kMinusInfinity;
  double nis = std::numeric_limits<double>::infinity();
};

Density densityOf(const Innovation& innovation, const ClassFilter& filter);

/// H P H' + R_model of a filter with one Gaussian on all axes, computed once for all measurements:
/// the same densities as densityOf() of their innovations at a fraction of the cost.
class ExpectedAxes {
 public:
  void set(const ClassFilter& f, const Kinematics& k, const AxisPrediction& p);
  /// Density of a measurement with these `axes`; `p`: the prediction given to set().
  Density densityOf(const AxisPrediction& p, const Measurement& m, const AxisList& axes,
                    const std::vector<AxisKind>& kinds) const;

 private:
  AxisMatrix S_;  ///< H P H' + R_model, without the measurement's R
};

}  // namespace perception
