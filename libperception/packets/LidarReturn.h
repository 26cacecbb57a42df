#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace perception {

/// One return of a lidar's packet, in the sensor's ROS axes (x forward, y left, z up).
struct LidarReturn {
  float x = 0, y = 0, z = 0;   ///< [m]
  std::uint8_t intensity = 0;  ///< as sent
  std::uint16_t ring = 0;      ///< rank of the beam's elevation, 0 = lowest
  std::uint8_t echo = 0;       ///< order in the packet: 0, or 1 for the second of a dual return
  float time_us = 0;           ///< after the packet's stamp [us]
};

/// Direction of a beam relative to the sensor's azimuth.
struct BeamAngles {
  double elevation = 0;  ///< [deg], up
  double azimuth = 0;    ///< [deg], clockwise, added to the packet's
};

/// Returns of a packet.
struct LidarPacket {
  std::uint32_t stamp_us = 0;  ///< the packet's own: Velodyne past the hour, Hesai past the second
  std::vector<LidarReturn> returns;
};

/// Rank of each beam by elevation, 0 = lowest.
std::vector<std::uint16_t> ringsOf(const std::vector<BeamAngles>& beams);

/// A return at a range [m] and a clockwise azimuth [deg] from the x axis.
LidarReturn returnAt(double range, double azimuth, double elevation);

}  // namespace perception
