#include "libperception/packets/lidars/Beams.h"

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

const std::vector<BeamAngles>& vlp16Beams() {
  static const std::vector<BeamAngles> beams = [] {
    std::vector<BeamAngles> list;
    for (int laser = 0; laser < 16; ++laser)
      list.push_back({laser % 2 == 0 ? laser - 15.0 : laser + 0.0, 0});
    return list;
  }();
  return beams;
}

const std::vector<BeamAngles>& hdl32eBeams() {
  static const std::vector<BeamAngles> beams = [] {
    std::vector<BeamAngles> list;
    for (int laser = 0; laser < 32; ++laser)
      list.push_back({(laser % 2 == 0 ? -30.67 : -9.33) + laser / 2 * 4 / 3.0, 0});
    return list;
  }();
  return beams;
}

const std::vector<BeamAngles>& vlp32cBeams() {
  static const std::vector<BeamAngles> beams = {
      {-25, 1.4},    {-1, -4.2},     {-1.667, 1.4}, {-15.639, -1.4}, {-11.31, 1.4}, {0, -1.4},
      {-.667, 4.2},  {-8.843, -1.4}, {-7.254, 1.4}, {.333, -4.2},    {-.333, 1.4},  {-6.148, -1.4},
      {-5.333, 4.2}, {1.333, -1.4},  {.667, 4.2},   {-4, -1.4},      {-4.667, 1.4}, {1.667, -4.2},
      {1, 1.4},      {-3.667, -4.2}, {-3.333, 4.2}, {3.333, -1.4},   {2.333, 1.4},  {-2.667, -1.4},
      {-3, 1.4},     {7, -1.4},      {4.667, 1.4},  {-2.333, -4.2},  {-2, 4.2},     {15, -1.4},
      {10.333, 1.4}, {-1.333, -1.4}};
  return beams;
}

const std::vector<BeamAngles>& pandar40pBeams() {
  static const std::vector<BeamAngles> beams = [] {
    std::vector<BeamAngles> list;
    const double high[] = {14.79, 10.94, 7.97, 4.97, 2.95, 1.94};
    const double low[] = {-7.15,  -8.15,  -9.15,  -10.13, -11.12,
                          -12.09, -13.06, -14.02, -18.98, -24.99};
    const double cycle[] = {3.125, -5.208, -1.042};
    for (const double e : high) list.push_back({e, -1.042});
    for (int k = 0; k < 24; ++k) list.push_back({1.60 - .337 * k, k < 23 ? cycle[k % 3] : -1.042});
    for (const double e : low) list.push_back({e, -1.042});
    return list;
  }();
  return beams;
}

const std::vector<BeamAngles>& xt32Beams() {
  static const std::vector<BeamAngles> beams = [] {
    std::vector<BeamAngles> list;
    for (int channel = 1; channel <= 32; ++channel) list.push_back({16.0 - channel, 0});
    return list;
  }();
  return beams;
}

}  // namespace perception
