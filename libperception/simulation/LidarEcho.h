#pragma once
#include "libperception/simulation/LidarParams.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// What a lidar receives of a pulse.
struct LidarEcho {
  bool received = false;
  bool of_surface = false;  ///< else of the air
  double range = 0;         ///< [m] without noise
  double intensity = 0;     ///< [0, 1] corrected for range, as instruments report it
  double snr = 0;           ///< against the detection threshold; of known returns not known: 0
  Phantom phantom = Phantom::kNone;
};

/// The echo of a pulse of which the surface returns `reflectivity` (losses included; 0: nothing).
/// The nearest scatterer of known intensity is received in any case; else the strongest echo, if it
/// is above the threshold: P0 = rho exp(-2 depth) / R^2 against P_min = 0.9 / R_max^2, method.md
/// (57).
LidarEcho echoOf(const LidarPulse& pulse, double reflectivity, const LidarParams& params);

}  // namespace perception
