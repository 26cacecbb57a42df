#pragma once
#include <memory>

#include "libperception/core/Angle.h"
#include "libperception/core/ParamSet.h"

namespace perception {

class PointFilter;

/// Dynamic statistical outlier removal (Kurup and Bos, 2021): [weather.dsor]. With the mean
/// distance to the nearest neighbours, a return is a phantom when its own exceeds (mean + spread *
/// deviation) * range_factor * range.
struct DsorParams {
  int neighbours = 5;          ///< (paper)
  double spread = 0.01;        ///< [-] (paper)
  double range_factor = 0.05;  ///< [1/m] (paper)

  void visit(ParamVisitor& v);
};

std::unique_ptr<PointFilter> makeDsor(const DsorParams& params);

}  // namespace perception
