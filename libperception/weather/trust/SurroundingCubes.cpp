#include "libperception/weather/trust/SurroundingCubes.h"

#include <algorithm>
#include <cmath>

#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

/// Numbering of the cubes.
struct CubeRules {
  float reach, bottom, per_meter;
  std::int32_t side, layers;

  std::int32_t along(float v) const {
    const auto i = static_cast<std::int32_t>((v + reach) * per_meter);
    return i < 0 ? 0 : i < side ? i : side - 1;
  }
  std::int32_t layer(float z) const {
    const auto i = static_cast<std::int32_t>((z - bottom) * per_meter);
    return i < 0 ? 0 : i < layers ? i : layers - 1;
  }
  std::int32_t column(std::int32_t x, std::int32_t y) const { return (x * side + y) * layers; }
};

/// For each point its cube, and its corner: along x and y the lower cube (10 bits) and the step to
/// the upper one (2 bits), along z 5 and 2 bits. The two are the cubes a quarter of an edge to
/// either side.
PERCEPTION_WIDEST void findAll(const float* __restrict x, const float* __restrict y,
                               const float* __restrict z, std::size_t count, const CubeRules k,
                               float half, std::uint32_t* __restrict cubes,
                               std::uint32_t* __restrict corners) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t cube = k.column(k.along(x[i]), k.along(y[i])) + k.layer(z[i]);
    const std::int32_t x0 = k.along(x[i] - half), y0 = k.along(y[i] - half);
    const std::int32_t x1 = k.along(x[i] + half), y1 = k.along(y[i] + half);
    const std::int32_t z0 = k.layer(z[i] - half), z1 = k.layer(z[i] + half);
    const std::int32_t aside = x0 | (x1 - x0) << 10 | y0 << 12 | (y1 - y0) << 22;
    cubes[i] = static_cast<std::uint32_t>(cube);
    corners[i] = static_cast<std::uint32_t>(aside) | static_cast<std::uint32_t>(z0) << 24 |
                 static_cast<std::uint32_t>(z1 - z0) << 29;
  }
}

}  // namespace

SurroundingCubes::SurroundingCubes(float reach)
    : reach_(reach),
      side_(std::min(1024, 2 * static_cast<int>(std::ceil(reach / kEdge)))),
      touched_(static_cast<std::size_t>(side_ * side_ * kLayers) / kTogether + 1, 0),
      counts_(touched_.size() * kTogether) {
  for (std::size_t n = 0; n < logs_.size(); ++n) logs_[n] = std::log(static_cast<float>(n + 1));
}

void SurroundingCubes::clear() {
  for (std::size_t piece = 0; piece < touched_.size(); ++piece) {
    if (touched_[piece] == 0) continue;
    std::fill_n(&counts_[piece * kTogether], kTogether, 0U);
    touched_[piece] = 0;
  }
}

void SurroundingCubes::locate(const float* x, const float* y, const float* z, std::size_t count,
                              std::uint32_t* cubes, std::uint32_t* corners) const {
  const CubeRules rules{reach_, kBottom, 1 / kEdge, side_, kLayers};
  findAll(x, y, z, count, rules, kEdge / 2, cubes, corners);
}

// Neighbors in a scan share cubes; interleaving four parts of the scan avoids that dependency.
void SurroundingCubes::add(const std::uint32_t* cubes, std::size_t count, std::uint32_t mask) {
  std::uint64_t* const counts = counts_.data();
  std::uint8_t* const touched = touched_.data();
  const std::size_t quarter = count / 4;
  const auto one = [&](std::size_t k) {
    const std::uint32_t cube = cubes[k] & mask;
    ++counts[cube], touched[cube / kTogether] = 1;
  };
  for (std::size_t k = 0; k < quarter; ++k)
    one(k), one(k + quarter), one(k + 2 * quarter), one(k + 3 * quarter);
  for (std::size_t k = 4 * quarter; k < count; ++k) one(k);
}

}  // namespace perception
