#pragma once
#include <memory>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Angle.h"

namespace perception {

class PointFilter;

/// Low-intensity outlier removal ([park2020], method.md 9.6): [weather.lior]. A
/// return is a phantom when it is dark and near, unless enough others lie close to it.
struct LiorParams {
  double max_intensity = 1.0 / 255;  ///< [0, 1] own choice for WADS, whose flakes have 0
  double max_range = 71;             ///< [m] (method.md 9.6)
  double radius = 0.1;               ///< [m] (method.md 9.6)
  int neighbors = 3;                 ///< (method.md 9.6)

  void visit(ParamVisitor& v);
};

std::unique_ptr<PointFilter> makeLior(const LiorParams& params);

}  // namespace perception
