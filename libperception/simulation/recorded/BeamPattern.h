#pragma once
#include <cstdint>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// The beams of a recorded lidar, as far as its scans show them: a log holds returns, and none of
/// the pulses that met nothing. A direction in which a scan had returns and another one has none is
/// one of them, unless a pulse beside it shows that the beams have merely moved a little. What
/// never returned (the sky above all else) stays unknown.
class BeamPattern {
 public:
  /// A pulse without a return.
  struct Beam {
    Vector3 direction;   ///< unit, sensor frame
    std::uint32_t slot;  ///< of its random numbers, one per beam of a scan
  };
  /// Learns the directions of a scan and returns the beams of earlier scans that it lacks, in a
  /// fixed order.
  std::vector<Beam> missing(const LidarCloud& cloud);

 private:
  /// Directions within 0.2 deg of azimuth and 0.4 deg of elevation: the spacing of an HDL-64E.
  struct Cell {
    Vector3 direction = Vector3::UnitX();  // of its last return
    double azimuth = 0, elevation = 0;     // [rad] of it
    double returns = 0;                    // of all scans
    std::uint32_t scans = 0;               // in which a pulse was seen here
    std::uint32_t last = 0;                // number of the last one
  };
  void see(Cell& cell);

  std::vector<std::uint32_t> number_;  // by direction: of its cell
  std::vector<Cell> cells_;            // in the order of their first returns
  std::uint32_t scan_ = 0;
};

}  // namespace perception
