#pragma once
#include <array>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Angle.h"

namespace perception {

/// Features of a return (method.md 9.6). Each contributes a curve to the log-odds of "phantom".
enum class TrustFeature {
  kRange,        ///< [m] from the sensor
  kTight,        ///< neighbors within `tight`
  kWide,         ///< neighbors within `wide`
  kBeyond,       ///< [-] share of the neighboring beams that pass behind
  kHeight,       ///< [m] above the ground plane
  kSurroundings  ///< ln((1 + surfaces) / (1 + phantoms)) within half a meter
};
constexpr std::size_t kTrustFeatures = 6;

/// Parameters of PointTrust: [weather.trust]. The curves, without intensity, and the terms of the
/// second pass were fitted by trust_study to the odd scans of WADS sequence 36 [kurup2021] (falling
/// snow, 128 beams); the knots are those of knotsOf().
struct TrustParams {
  double column = radians(0.2);  ///< [rad] of azimuth in a pixel of the range image (assumed)
  double row = 0;                ///< [rad] of elevation in a pixel; 0: found from the first scan
  double max_range = 20;         ///< [m] beyond it, flakes give few returns (WADS: 2 of 1000)
  double tight = 0.02;        ///< [-] of the range, + 3 cm: neighbor on the same surface (assumed)
  double wide = 0.04;         ///< [-] of the range, + 3 cm (assumed)
  double beyond = 0.1;        ///< [-] of the range, + 30 cm: a beam that passes behind (assumed)
  int surface_neighbors = 6;  ///< of the eight nearest within `tight`: a surface (assumed)

  std::array<std::vector<double>, kTrustFeatures> curves;  ///< [log-odds] at the knots
  double bias = -3.95;                                     ///< [log-odds] of the first pass
  /// Second pass, with kSurroundings: [-] of the first pass's log-odds, [log-odds].
  double gain = 0.32, second_bias = 4.75;

  bool use_intensity = true;
  double intensity_gain = 0.8;   ///< [-] of the learned log-likelihood ratio (assumed)
  double intensity_memory = 10;  ///< [scans] of the learned intensities (assumed)
  bool adapt_share = true;       ///< adapt the share of phantoms to the weather
  double fitted_share = 0.1457;  ///< [-] of phantoms within share_range in the scans of the fit
  double share_range = 15;       ///< [m] (assumed)
  double share_memory = 10;      ///< [scans] (assumed)
  double share_gain = 0.5;    ///< [-] of the change of log-odds; 1: Bayes (docs/decisions/lidar.md)
  double least_share = 1e-4;  ///< [-] of phantoms in clear air (assumed)
  double sensor_label = 4;    ///< [log-odds] of the sensor's own label rain or dirt (assumed)
  double rain_rule = 2;       ///< [log-odds] a first echo weaker or shorter than the next (assumed)

  TrustParams();
  static const std::vector<double>& knotsOf(TrustFeature feature);
  void visit(ParamVisitor& v);
};

}  // namespace perception
