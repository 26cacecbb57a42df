#include "libperception/weather/SurroundingCubes.h"

#include <algorithm>
#include <cmath>

namespace perception {

SurroundingCubes::SurroundingCubes(float reach)
    : reach_(reach),
      side_(2 * static_cast<int>(std::ceil(reach / kEdge))),
      counts_(2 * static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * kLayers) {}

void SurroundingCubes::clear() { std::fill(counts_.begin(), counts_.end(), std::uint16_t{0}); }

float SurroundingCubes::company(float x, float y, float z, bool doubted) const {
  constexpr float kHalf = kEdge / 2;
  const int x0 = along(x - kHalf), x1 = along(x + kHalf);
  const int y0 = along(y - kHalf), y1 = along(y + kHalf);
  const int z0 = layer(z - kHalf), z1 = layer(z + kHalf);
  unsigned trusted = 0, others = 0;
  for (const int cx : {x0, x1})
    for (const int cy : {y0, y1}) {
      const std::uint16_t* column =
          counts_.data() + 2 * static_cast<std::size_t>((cx * side_ + cy) * kLayers);
      trusted += column[2 * z0] + column[2 * z1];
      others += column[2 * z0 + 1] + column[2 * z1 + 1];
    }
  if (doubted) {
    others -= std::min(others, 1U);
  } else {
    trusted -= std::min(trusted, 1U);
  }
  return std::log(static_cast<float>(1 + trusted) / static_cast<float>(1 + others));
}

}  // namespace perception
