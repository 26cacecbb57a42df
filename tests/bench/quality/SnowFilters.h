#pragma once
#include <memory>

#include "libperception/core/math/Angle.h"
#include "libperception/weather/PointFilter.h"

namespace perception::bench {

/// Snow filters of the literature, to compare the trust of returns with. They say yes or no: trust
/// 0 or 1.

/// Dynamic radius outlier removal [charron2018]: a return is a phantom when fewer than `neighbors`
/// others lie within max(radius_min, multiplier * range * azimuth).
struct DrorParams {
  double azimuth = radians(0.16);  ///< [rad] between beams [charron2018]
  double multiplier = 3;           ///< [-] [charron2018]
  double radius_min = 0.04;        ///< [m] [charron2018]
  int neighbors = 3;               ///< [charron2018]
  double max_intensity = 1;        ///< [0, 1] brighter returns are no phantoms; 1: all may be
  double max_range = 1000;         ///< [m] farther ones, neither
};
std::unique_ptr<PointFilter> makeDror(const DrorParams& params);

/// Dynamic statistical outlier removal [kurup2021]: with the mean distance to the nearest
/// neighbors, a return is a phantom when its own exceeds (mean + spread * deviation) * range_factor
/// * range.
struct DsorParams {
  int neighbors = 5;           ///< [kurup2021]
  double spread = 0.01;        ///< [-] [kurup2021]
  double range_factor = 0.05;  ///< [1/m] [kurup2021]
};
std::unique_ptr<PointFilter> makeDsor(const DsorParams& params);

/// Low-intensity outlier removal [park2020]: a return is a phantom when it is dark and near, unless
/// enough others lie close to it.
struct LiorParams {
  double max_intensity = 1.0 / 255;  ///< [0, 1] assumed, for WADS, whose flakes have 0
  double max_range = 71;             ///< [m] [park2020]
  double radius = 0.1;               ///< [m] [park2020]
  int neighbors = 3;                 ///< [park2020]
};
std::unique_ptr<PointFilter> makeLior(const LiorParams& params);

}  // namespace perception::bench
