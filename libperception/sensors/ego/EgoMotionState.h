#pragma once
#include <cstdint>
#include <optional>
#include <utility>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/sensors/ego/CEgoFilter.h"
#include "libperception/sensors/ego/EgoReadings.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// The complete state of the fusion, as a value, so that the filter can return to it for late
/// readings.
struct EgoMotionState {
  /// A fix while the heading is unknown, with the estimated pose at that time.
  struct Reference {
    Stamp stamp;
    Vector3 enu;      ///< [m]
    Vector2 place;    ///< [m] start frame
    double yaw;       ///< [rad] start frame
    Vector3 antenna;  ///< [m] in the vehicle frame
    double sigma;     ///< [m]
  };

  bool started = false;
  Stamp first, stamp;
  EgoEstimate estimate;
  std::optional<std::pair<Stamp, ImuReading>> imu;
  std::optional<std::pair<Stamp, WheelReading>> wheels;
  bool had_wheels = false;
  /// Sums of inertial readings since the last update by gravity.
  struct {
    std::optional<Stamp> begin;
    int count = 0;
    Vector3 force = Vector3::Zero();  ///< [m/s^2] sum
    double turning = 0;               ///< [rad/s] sum of yaw rates as measured
  } level;
  bool heading_known = false;
  std::optional<Reference> reference, last_fix;
  std::optional<Geodetic> origin;           ///< of east, north, up
  double world_turn = 0;                    ///< [rad] of the world's x axis from east
  Vector3 world_shift = Vector3::Zero();    ///< [m] origin of the world in east, north, up
  Pose3 T_world_start = Pose3::Identity();  ///< pose of the start frame
  std::uint64_t relocations = 0, fixes = 0, rejected_fixes = 0;
  int rejected_in_row = 0, rejected_heights_in_row = 0;

  Vector3 toWorld(const Vector3& enu) const;
};

}  // namespace perception
