#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/importers/ImportText.h"

namespace perception {

/// Where a receiver was, on WGS 84.
struct GpsFix {
  Stamp stamp;
  double latitude = 0, longitude = 0;  ///< [deg]
  double altitude = 0;                 ///< [m]
};

/// The fix as CObservationGPS with a GGA message.
std::shared_ptr<mrpt::obs::CObservation> gpsObservation(const GpsFix& fix,
                                                        const std::string& label = "GPS");

/// Meters east and north of the first fix.
std::vector<Vector2> localPositions(const std::vector<GpsFix>& fixes);

/// A moving receiver as the vehicle's poses: x east, y north, heading by the course over
/// `course_distance` [m] about each fix. Where it hardly moves the course before holds.
std::vector<StampedPose> posesOfFixes(const std::vector<GpsFix>& fixes, double course_distance = 2);

}  // namespace perception
