#include "libperception/weather/SurroundingCubes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/Wider.h"

namespace perception {
namespace {

/// How cubes are numbered.
struct CubeRules {
  float reach, bottom, per_metre;
  float far;  ///< [m]
  std::int32_t side, layers;
};

/// ln(1 + count), from a table where counts are as usual.
float logOfOneMore(std::uint32_t count) {
  static const std::array<float, 1024> kLogs = [] {
    std::array<float, 1024> logs{};
    for (std::size_t n = 0; n < logs.size(); ++n) logs[n] = std::log(static_cast<float>(n + 1));
    return logs;
  }();
  return count < kLogs.size() ? kLogs[count] : std::log(static_cast<float>(count) + 1);
}

inline float bounded(float v, float most) {
  const float low = v > 0 ? v : 0;
  return low < most ? low : most;
}

PERCEPTION_WIDER void findCubes(const float* __restrict x, const float* __restrict y,
                                const float* __restrict z, const float* __restrict range,
                                std::size_t count, CubeRules k, std::uint32_t* __restrict cube) {
  const auto last = static_cast<float>(k.side - 1), top = static_cast<float>(k.layers - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const auto cx = static_cast<std::int32_t>(bounded((x[i] + k.reach) * k.per_metre, last));
    const auto cy = static_cast<std::int32_t>(bounded((y[i] + k.reach) * k.per_metre, last));
    const auto cz = static_cast<std::int32_t>(bounded((z[i] - k.bottom) * k.per_metre, top));
    const std::int32_t counts = (range[i] > 0) & (range[i] <= k.far);
    cube[i] = static_cast<std::uint32_t>(counts != 0 ? (cx * k.side + cy) * k.layers + cz
                                                     : k.side * k.side * k.layers);
  }
}

}  // namespace

SurroundingCubes::SurroundingCubes(float reach)
    : reach_(reach),
      side_(2 * static_cast<int>(std::ceil(reach / kEdge))),
      trusted_(columnAt(side_, 0) + 1),
      doubted_(trusted_.size()) {}

void SurroundingCubes::clear() {
  std::fill(trusted_.begin(), trusted_.end(), 0U);
  std::fill(doubted_.begin(), doubted_.end(), 0U);
}

void SurroundingCubes::add(const float* x, const float* y, const float* z, const float* range,
                           std::size_t count, float far) {
  constexpr std::size_t kBlock = 512, kQuarter = kBlock / 4;
  const CubeRules rules{reach_, kBottom, 1 / kEdge, far, side_, kLayers};
  std::array<std::uint32_t, kBlock> cube;
  std::uint32_t* trusted = trusted_.data();
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min(kBlock, count - first);
    findCubes(x + first, y + first, z + first, range + first, size, rules, cube.data());
    // Neighbours in a scan share cubes; four places by turns do not wait for each other.
    std::fill(cube.begin() + static_cast<std::ptrdiff_t>(size), cube.end(),
              static_cast<std::uint32_t>(trusted_.size() - 1));
    for (std::size_t k = 0; k < kQuarter; ++k)
      ++trusted[cube[k]], ++trusted[cube[k + kQuarter]], ++trusted[cube[k + 2 * kQuarter]],
          ++trusted[cube[k + 3 * kQuarter]];
  }
}

float SurroundingCubes::company(float x, float y, float z, bool doubted) const {
  constexpr float kHalf = kEdge / 2;
  const int x0 = along(x - kHalf), x1 = along(x + kHalf);
  const int y0 = along(y - kHalf), y1 = along(y + kHalf);
  const auto z0 = static_cast<std::size_t>(layer(z - kHalf)),
             z1 = static_cast<std::size_t>(layer(z + kHalf));
  std::uint32_t trusted = 0, others = 0;
  for (const std::size_t column :
       {columnAt(x0, y0), columnAt(x0, y1), columnAt(x1, y0), columnAt(x1, y1)}) {
    trusted += trusted_[column + z0] + trusted_[column + z1];
    others += doubted_[column + z0] + doubted_[column + z1];
  }
  if (doubted) {
    others -= std::min(others, 1U);
  } else {
    trusted -= std::min(trusted, 1U);
  }
  return logOfOneMore(trusted) - logOfOneMore(others);
}

}  // namespace perception
