#include "libperception/simulation/recorded/BeamPattern.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kAcross = radians(0.2), kUp = radians(0.4);
constexpr std::uint32_t kMostInCell = 16;

std::uint32_t keyOf(const Vector3& direction) {
  // Beams at round angles lie in the middle of a cell.
  const double azimuth = std::atan2(direction.y(), direction.x()) + kPi + kAcross / 2,
               elevation = std::asin(std::clamp(direction.z(), -1.0, 1.0)) + kPi / 2 + kUp / 2;
  return static_cast<std::uint32_t>(elevation / kUp) << 16 |
         static_cast<std::uint32_t>(azimuth / kAcross);
}

}  // namespace

std::vector<BeamPattern::Beam> BeamPattern::missing(const LidarCloud& cloud) {
  ++scan_;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 place(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                        static_cast<double>(cloud.z[i]));
    const double range = place.norm();
    if (!(range > 0)) continue;
    const Vector3 direction = place / range;
    const auto [at, is_new] = number_.try_emplace(keyOf(direction), cells_.size());
    if (is_new) cells_.emplace_back();
    Cell& cell = cells_[at->second];
    cell.direction = direction;
    cell.scans += cell.last != scan_, cell.last = scan_;
    ++cell.returns;
  }
  std::vector<Beam> beams;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    if (cell.last == scan_) continue;
    const auto count =
        std::min(kMostInCell, static_cast<std::uint32_t>(std::lround(cell.returns / cell.scans)));
    for (std::uint32_t k = 0; k < count; ++k)
      beams.push_back({cell.direction, static_cast<std::uint32_t>(c) * kMostInCell + k});
  }
  return beams;
}

}  // namespace perception
