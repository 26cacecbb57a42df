#include "libperception/weather/SurroundingCubes.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Wider.h"

namespace perception {
namespace {

/// How cubes are numbered.
struct CubeRules {
  float reach, bottom, per_metre;
  std::int32_t side, layers;
};

inline float bounded(float v, float most) {
  const float low = v > 0 ? v : 0;
  return low < most ? low : most;
}

PERCEPTION_WIDER void findCubes(const float* __restrict x, const float* __restrict y,
                                const float* __restrict z, std::size_t count, CubeRules k,
                                std::uint32_t* __restrict cube) {
  const auto last = static_cast<float>(k.side - 1), top = static_cast<float>(k.layers - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const auto cx = static_cast<std::int32_t>(bounded((x[i] + k.reach) * k.per_metre, last));
    const auto cy = static_cast<std::int32_t>(bounded((y[i] + k.reach) * k.per_metre, last));
    const auto cz = static_cast<std::int32_t>(bounded((z[i] - k.bottom) * k.per_metre, top));
    cube[i] = static_cast<std::uint32_t>((cx * k.side + cy) * k.layers + cz);
  }
}

}  // namespace

SurroundingCubes::SurroundingCubes(float reach)
    : reach_(reach),
      side_(2 * static_cast<int>(std::ceil(reach / kEdge))),
      counts_(2 * static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * kLayers) {}

void SurroundingCubes::clear() { std::fill(counts_.begin(), counts_.end(), std::uint16_t{0}); }

void SurroundingCubes::place(const std::vector<float>& x, const std::vector<float>& y,
                             const std::vector<float>& z) {
  cube_of_.resize(x.size());
  findCubes(x.data(), y.data(), z.data(), x.size(), {reach_, kBottom, 1 / kEdge, side_, kLayers},
            cube_of_.data());
}

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
