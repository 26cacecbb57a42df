#pragma once
#include <array>
#include <cstddef>

#include "libperception/measurement/frames/AirClouds.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/weather/trust/SuspectReturns.h"

namespace perception {

/// Returns of a lidar scan counted by direction, height and range: what WeatherState tells the
/// weather from (method.md 9.10). Directions are relative to the ground plane.
struct AirCensus {
  static constexpr std::size_t kSectors = AirClouds::kSectors;
  /// [m] edges of the shells in which returns in free air are counted.
  static constexpr std::array<float, 6> kShells = {1.5F, 2.5F, 4, 6, 10, 20};
  static constexpr std::size_t kShellCount = kShells.size() - 1;
  static constexpr std::size_t kReachBins = 64;  ///< of 2 m

  /// One direction; numbers of returns beyond the first shell's near edge.
  struct Sector {
    double returns = 0;
    double level = 0;  ///< between 2 deg below and 1 deg above the horizon
    /// In free air by shell: more than 0.4 m above the ground, and no neighbor on a surface with
    /// it.
    std::array<double, kShellCount> lone{};
    /// Of those the ones between 2 deg below and 1 deg above the horizon.
    std::array<double, kShellCount> level_lone{};
    /// Level returns that are not in free air and nearer than 40 m: nothing is seen behind.
    double blocked = 0;
    /// Between 7.5 and 4.5 deg below the horizon, where the road or what stands on it always
    /// returns: as many beams as in the level band.
    double below = 0;
    /// [m] sum over level_lone of the first shell: intensity times range; and how many have one.
    double brightness = 0, lit = 0;
  };
  std::array<Sector, kSectors> sectors;
  double max_range = 0;  ///< [m] of the instrument by its data sheet; 0 = unknown
  /// Returns by range: of the ground (within 0.4 m of the plane), and of what stands on it.
  std::array<double, kReachBins> ground{}, upright{};

  /// Counts a scan; `suspects` as PointTrust left them.
  static AirCensus of(const SensorFrame& frame, const LidarCloud& cloud,
                      const SuspectReturns& suspects);
};

}  // namespace perception
