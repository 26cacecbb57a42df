#pragma once
#include <memory>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Angle.h"

namespace perception {

class PointFilter;

/// Dynamic radius outlier removal (Charron et al., CRV 2018): [weather.dror]. A return is a phantom
/// when fewer than `neighbors` others lie within max(radius_min, multiplier * range * azimuth).
struct DrorParams {
  double azimuth = radians(0.16);  ///< [rad] between beams (method.md 9.6)
  double multiplier = 3;           ///< [-] (paper)
  double radius_min = 0.04;        ///< [m] (paper)
  int neighbors = 3;               ///< (paper)
  double max_intensity = 1;        ///< [0, 1] brighter returns are no phantoms; 1: all may be
  double max_range = 1000;         ///< [m] farther ones, neither

  void visit(ParamVisitor& v);
};

std::unique_ptr<PointFilter> makeDror(const DrorParams& params);

}  // namespace perception
