#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// Up to where a pulse is in the air [m]: the surface, or far away.
double openRange(const LidarPulse& pulse);

/// Adds the extinction [1/m] of uniform air up to the surface.
void attenuate(LidarPulse& pulse, double extinction);

/// Cells of directions in a sensor's frame: what fills one is seen by all beams through it.
class AimGrid {
 public:
  explicit AimGrid(double size);  ///< [rad] in azimuth and elevation; 2 pi is a multiple of it
  /// Shifts the grid by these shares of a cell.
  void shift(double across, double up) { across_ = across, up_ = up; }
  std::size_t cells() const { return columns_ * rows_; }

  /// Where a direction is.
  struct Place {
    std::size_t cell;
    double across, up;  ///< [0, 1) in the cell
  };
  Place at(double azimuth, double elevation) const;  ///< [rad]

 private:
  double size_, across_ = 0, up_ = 0;
  std::size_t columns_, rows_;
};

/// Purpose of random numbers of one sensor.
std::uint32_t streamOf(const std::string& sensor_label, std::uint32_t purpose);

}  // namespace perception
