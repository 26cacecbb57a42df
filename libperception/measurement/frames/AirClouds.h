#pragma once
#include <array>
#include <cstddef>

#include "libperception/core/Frames.h"

namespace perception {

/// Clouds of particles that a lidar sees in the air near by, such as spray, dust or exhaust, by
/// direction (method.md 9.10).
struct AirClouds {
  static constexpr std::size_t kSectors = 24;  ///< of 15 deg of azimuth
  static constexpr double kReach = 20;         ///< [m] from the sensor

  /// [0, 1] P(a cloud hangs in the sector); the first one begins at the azimuth -pi.
  std::array<double, kSectors> probability{};
  Pose3 T_sensor_world = Pose3::Identity();

  /// [0, 1] P(a cloud hangs at a place [m, world]); 0 beyond kReach.
  double at(const Vector2& place) const;
};

}  // namespace perception
