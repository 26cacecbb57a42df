#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/importers/ImportText.h"

namespace perception {

/// Position of a receiver, WGS 84.
struct GpsFix {
  Stamp stamp;
  double latitude = 0, longitude = 0;  ///< [deg]
  double altitude = 0;                 ///< [m]
};

/// The fix as CObservationGPS with a GGA message.
std::shared_ptr<mrpt::obs::CObservation> gpsObservation(const GpsFix& fix,
                                                        const std::string& label = "GPS");

/// East and north of the first fix [m].
std::vector<Vector2> localPositions(const std::vector<GpsFix>& fixes);

/// Ego poses from a moving receiver: x east, y north, heading from the course over
/// `course_distance` [m] about each fix. At low speed the last course is kept.
std::vector<StampedPose> posesOfFixes(const std::vector<GpsFix>& fixes, double course_distance = 2);

}  // namespace perception
