#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/packets/Decoder.h"

namespace perception {

/// Direction of a beam relative to the sensor's azimuth.
struct BeamAngles {
  double elevation = 0;  ///< [deg], up
  double azimuth = 0;    ///< [deg], clockwise, added to the packet's
};

/// Rank of each beam by elevation, 0 = lowest.
std::vector<std::uint16_t> ringsOf(const std::vector<BeamAngles>& beams);

/// The beams of a table "Laser id,Elevation,Azimuth" [deg], as Hesai ships with each unit.
/// Throws DataError with file and line; `count`: of the lasers expected.
std::vector<BeamAngles> readBeams(const std::string& path, std::size_t count);

/// Beams of the models, in the order of their channels: those of the manuals, of Hesai's the
/// nominal ones.
const std::vector<BeamAngles>& vlp16Beams();
const std::vector<BeamAngles>& hdl32eBeams();
const std::vector<BeamAngles>& vlp32cBeams();
const std::vector<BeamAngles>& pandar40pBeams();
const std::vector<BeamAngles>& xt32Beams();

/// A return at a range [m] and a clockwise azimuth [deg] from the x axis.
LidarReturn returnAt(double range, double azimuth, double elevation);

}  // namespace perception
