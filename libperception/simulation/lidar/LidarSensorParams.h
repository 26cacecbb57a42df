#pragma once
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Angle.h"

namespace perception {

/// A scanning lidar: [sensor.LABEL] kind = lidar64 or lidar4. Defaults: HDL-64E (data sheet,
/// KITTI's pattern), loss and label errors assumed.
struct LidarSensorParams {
  /// Elevations of its rings.
  enum class Layout { kHdl64, kFourLayer };
  Layout layout = Layout::kHdl64;  ///< elevations of the beams; from the sensor's kind
  double azimuth_from = -kPi,
         azimuth_to = kPi;              ///< [rad] of the sensor's forward axis, to the left
  double azimuth_step = radians(0.18);  ///< [rad] 0.16 to 0.2 deg at 10 turns a second
  double elevation_from = -kPi / 2, elevation_to = kPi / 2;  ///< [rad] rings outside are omitted
  int ring_step = 1;          ///< keeps every n-th ring, to thin a log
  std::vector<double> rings;  ///< [rad] elevations, lowest first, of another lidar; not in an INI
  double range_min = 0.9;     ///< [m]
  double range_max = 120;     ///< [m]
  double reference_range =
      200;  ///< [m] R_max of method.md (57): detection limit of a surface of 90 % reflectivity
  double range_noise = 0.01;  ///< [m] at the strongest echo
  double loss = 0.003;        ///< share of pulses lost independent of the target
  /// [rad] full beam divergence (method.md 9: 3 mrad). A beam on an edge returns the stronger echo
  /// of the two surfaces, or their mean if they are within one pulse length. 0: an ideal ray.
  double divergence = 0;
  double label_error = 0;  ///< share of wrong point labels (four layers: object, ground)
  bool sweep = false;      ///< true: each beam has its own time within the turn

  /// Ibeo ALASCA XT: four layers 0.8 deg apart, 0.25 deg in azimuth, own labels.
  static LidarSensorParams fourLayer();
  void visit(ParamVisitor& v);
  /// Elevations [rad] of the rings, lowest first: `rings`, or those of the layout.
  std::vector<double> elevations() const;
};

}  // namespace perception
