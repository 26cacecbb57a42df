#include "libperception/packets/Beams.h"

#include <cmath>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"

namespace perception {

std::vector<std::uint16_t> ringsOf(const std::vector<BeamAngles>& beams) {
  std::vector<std::uint16_t> rings;
  for (const BeamAngles& beam : beams) {
    std::uint16_t lower = 0;
    for (const BeamAngles& other : beams) {
      if (other.elevation < beam.elevation) ++lower;
    }
    rings.push_back(lower);
  }
  return rings;
}

std::vector<BeamAngles> readBeams(const std::string& path, std::size_t count) {
  const CsvTable table = CsvTable::fromFile(path);
  const auto elevation = table.column("Elevation"), azimuth = table.column("Azimuth");
  if (table.rows() != count) {
    throw DataError(path + ": " + std::to_string(table.rows()) + " beams, expected " +
                    std::to_string(count));
  }
  std::vector<BeamAngles> beams;
  for (std::size_t i = 0; i < count; ++i)
    beams.push_back({table.real(i, elevation), table.real(i, azimuth)});
  return beams;
}

LidarReturn returnAt(double range, double azimuth, double elevation) {
  constexpr double kRadians = M_PI / 180;
  const double flat = range * std::cos(elevation * kRadians);
  LidarReturn point;
  point.x = static_cast<float>(flat * std::cos(azimuth * kRadians));
  point.y = static_cast<float>(-flat * std::sin(azimuth * kRadians));
  point.z = static_cast<float>(range * std::sin(elevation * kRadians));
  return point;
}

}  // namespace perception
