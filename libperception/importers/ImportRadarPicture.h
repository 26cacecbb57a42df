#pragma once
#include <string>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// How a turning radar's picture becomes returns.
struct RadarPictureParams {
  double pixel = 0.17361;  ///< [m] of Navtech_Cartesian (RADIATE's paper)
  int beams = 400;         ///< of one turn (RADIATE's polar pictures)
  double range = 100;      ///< [m] of the radar (RADIATE's paper)
  double nearest = 3;      ///< [m] the vehicle's own roof and the antenna's ringing
  /// The strongest echoes of each beam stand for the picture, as in CFEAR radar odometry
  /// [adolfsson2021] (k = 12, 60 of 255), here of those that are a maximum.
  int strongest = 12;
  int least_power = 60;  ///< [0, 255]
  /// An echo stands for its surroundings: one reflector lights the beams and cells around it.
  int around_beams = 2;  ///< the beam of 1.8 deg has twice the width of a step
  int around_cells = 3;  ///< half a meter
};

/// Echoes of a picture from above, the vehicle in its center, up = forward. Without range rates,
/// which such a picture does not show. Throws DataError where the file is no image.
RadarReturns radarReturnsOf(const std::string& path, const RadarPictureParams& params);

}  // namespace perception
