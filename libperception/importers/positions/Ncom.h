#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <optional>
#include <string_view>

#include "libperception/core/Time.h"

namespace perception {

/// What an inertial navigation system says. One of OxTS says it in a packet of its NCOM format (72
/// bytes, little-endian). Source: the maker's manual of the format, written down without it at hand
/// and not tried on a recording.
struct NcomState {
  double latitude = 0, longitude = 0;    ///< [deg] WGS 84
  double altitude = 0;                   ///< [m] above the ellipsoid
  double north = 0, east = 0, down = 0;  ///< [m/s]
  double heading = 0;                    ///< [deg] clockwise from north
  double pitch = 0, roll = 0;            ///< [deg] nose up, right side down
};

/// Empty: the system is not locked. Throws std::runtime_error: not a whole packet.
std::optional<NcomState> ncomState(std::string_view packet);

/// The state as CObservationGPS with a message of another inertial navigation system that MRPT
/// knows (INSPVAS of NovAtel): place, velocity and attitude.
std::shared_ptr<mrpt::obs::CObservation> ncomObservation(Stamp stamp, const NcomState& state);

}  // namespace perception
