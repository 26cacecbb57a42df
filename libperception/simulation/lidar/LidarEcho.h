#pragma once
#include <optional>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/lidar/LidarSensorParams.h"

namespace perception {

/// What a lidar receives of a pulse.
struct LidarEcho {
  bool received = false;
  bool of_surface = false;  ///< else of the air
  double range = 0;         ///< [m] without noise
  double intensity = 0;     ///< [0, 1] corrected for range, as instruments report it
  double snr = 0;           ///< against the detection threshold; of known returns not known: 0
  double level = 0;         ///< amplitude against the threshold; of known returns from intensity
  double width = 0;         ///< [m] duration above the threshold, where it was asked for
  Phantom phantom = Phantom::kNone;
};

/// The echo of a pulse of which the surface returns `reflectivity` (losses included; 0: nothing).
/// The nearest scatterer of known intensity is received in any case; else the strongest echo, if it
/// is above the threshold: P0 = rho exp(-2 depth) / R^2 against P_min = 0.9 / R_max^2, method.md
/// (57).
LidarEcho echoOf(const LidarPulse& pulse, double reflectivity, const LidarSensorParams& params);

/// The surface behind a received drop, flake or cloud, where a four-layer scanner resolves it: a
/// pulse's length or more behind and above the threshold (method.md 9.9).
std::optional<LidarEcho> secondEchoOf(const LidarPulse& pulse, const LidarEcho& first,
                                      double reflectivity, const LidarSensorParams& params);

/// [m] for how long an echo is above the threshold (method.md 9.9); `slant` [m]: depth of the
/// surface within the beam.
double pulseWidth(double snr, double slant);

/// The rain rule of the four-layer scanners of [radecki2016]: of two echoes the first is rain if it
/// is lower or shorter.
bool isRain(const LidarEcho& first, const LidarEcho& second);

}  // namespace perception
