#pragma once
#include <cstdint>
#include <string>

#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// Up to where a pulse is in the air [m]: the surface, or far away.
double openRange(const LidarPulse& pulse);

/// Adds the extinction [1/m] of uniform air up to the surface.
void attenuate(LidarPulse& pulse, double extinction);

/// A cell of directions in a sensor's frame: what fills it is seen by all beams through it.
struct AimCell {
  std::uint32_t index;        ///< one per cell
  double across = 0, up = 0;  ///< [0, 1) place of the aim in the cell
};
/// Cells of `size` [rad], 2 pi a multiple of it, in azimuth and elevation; the grid is shifted by
/// these shares of a cell.
AimCell aimCell(const Vector3& aim, double size, double shift_across = 0, double shift_up = 0);

/// Purpose of random numbers of one sensor.
std::uint32_t streamOf(const std::string& sensor_label, std::uint32_t purpose);

}  // namespace perception
