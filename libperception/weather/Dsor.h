#pragma once
#include <memory>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Angle.h"

namespace perception {

class PointFilter;

/// Dynamic statistical outlier removal (Kurup and Bos, 2021): [weather.dsor]. With the mean
/// distance to the nearest neighbors, a return is a phantom when its own exceeds (mean + spread *
/// deviation) * range_factor * range.
struct DsorParams {
  int neighbors = 5;           ///< (paper)
  double spread = 0.01;        ///< [-] (paper)
  double range_factor = 0.05;  ///< [1/m] (paper)

  void visit(ParamVisitor& v);
};

std::unique_ptr<PointFilter> makeDsor(const DsorParams& params);

}  // namespace perception
