#pragma once
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <cstdint>
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Counts of dropped returns in the packets of a Velodyne scan.
struct VelodyneCounts {
  std::uint64_t no_return = 0;   ///< pulses without an echo
  std::uint64_t too_near = 0;    ///< echoes nearer than the instrument's least range
  std::uint64_t duplicates = 0;  ///< dual returns of the same echo
  std::uint64_t bad_blocks = 0;  ///< blocks with an unknown bank or an azimuth beyond 360 deg
};

/// All returns of a VLP-16, HDL-32E or HDL-64E scan in the sensor frame (x forward, y left), with
/// beam number, time and echo, each pulse at its own azimuth: decoded from the raw packets and the
/// scan's calibration, since MRPT 2.5.8 decodes only 16 of the 32 returns of a block. Of dual
/// returns the nearer echo is number 0. Empty without a known calibration for 16, 32 or 64 lasers.
std::optional<LidarCloud> velodyneCloud(const mrpt::obs::CObservationVelodyneScan& scan,
                                        VelodyneCounts* counts = nullptr);

}  // namespace perception
