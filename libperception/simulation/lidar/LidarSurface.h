#pragma once
#include "libperception/simulation/lidar/LidarCaster.h"

namespace perception {

/// How a material returns a lidar's light. Reflectivities at 905 nm: usual figures of lidar data
/// sheets; the road's grazing exponent is set by calculation so that dry asphalt is seen to 45-50
/// m.
struct LidarSurface {
  double reflectivity;  ///< [0, 1] at normal incidence
  double grazing;       ///< exponent of the cosine: 1 = Lambert, less = rough
  double lost;          ///< share of pulses transmitted or reflected specularly
};
const LidarSurface& lidarSurface(Material material);

/// [0, 1] towards the sensor: of the material at that incidence.
double lidarReflectivity(const BeamHit& hit);

}  // namespace perception
