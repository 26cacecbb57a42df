#pragma once
#include <string>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// The fixes of a GPS receiver in order of time.
struct PositionTrack {
  struct Fix {
    double t = 0;  ///< [s]; since midnight (NMEA), since 1970 (GPX), as in the file (CSV)
    double latitude = 0, longitude = 0;  ///< [deg] WGS 84
  };
  std::string name;
  std::vector<Fix> fixes;
  std::size_t dropped = 0;  ///< lines without a valid fix or out of order

  /// Positions [m] east and north of the first fix, on the tangent plane of the ellipsoid
  /// (centimeter accuracy over kilometers).
  std::vector<Vector2> local() const;
};

/// Reads NMEA 0183 (GGA sentences, checksums checked), GPX 1.1 (track points), or CSV with the
/// columns t_s, lat_deg, lon_deg; selected by the file extension (.nmea .txt .log, .gpx, .csv).
/// Throws DataError naming file and line.
PositionTrack readPositionTrack(const std::string& path);

}  // namespace perception
