#include "libperception/grid/WindowFrame.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/Wider.h"

namespace perception {
namespace {

using Double4 = double __attribute__((vector_size(32)));
using Float4 = float __attribute__((vector_size(16)));

// Doubles as far as places of the world go, floats from the window's corner on. Four points at a
// time; a double behind the last one is read.
PERCEPTION_WIDER void toCells(const double* xyz, std::size_t count, const double* corner,
                              double per_metre, float* x, float* y, float* z) {
  const Double4 from = {corner[0], corner[1], corner[2], 0};
  for (std::size_t i = 0; i < count; i += 4, xyz += 12) {
    Float4 row[4];
    for (std::size_t k = 0; k < 4; ++k) {
      Double4 v;
      std::memcpy(&v, xyz + 3 * k, sizeof v);
      row[k] = __builtin_convertvector((v - from) * per_metre, Float4);
    }
    using Int4 = std::int32_t __attribute__((vector_size(16)));
    const Float4 xy01 = __builtin_shuffle(row[0], row[1], Int4{0, 4, 1, 5});
    const Float4 xy23 = __builtin_shuffle(row[2], row[3], Int4{0, 4, 1, 5});
    const Float4 z01 = __builtin_shuffle(row[0], row[1], Int4{2, 6, 3, 7});
    const Float4 z23 = __builtin_shuffle(row[2], row[3], Int4{2, 6, 3, 7});
    const Float4 xs = __builtin_shuffle(xy01, xy23, Int4{0, 1, 4, 5});
    const Float4 ys = __builtin_shuffle(xy01, xy23, Int4{2, 3, 6, 7});
    const Float4 zs = __builtin_shuffle(z01, z23, Int4{0, 1, 4, 5});
    std::memcpy(x + i, &xs, sizeof xs), std::memcpy(y + i, &ys, sizeof ys);
    std::memcpy(z + i, &zs, sizeof zs);
  }
}

PERCEPTION_WIDER void placeAll(const float* __restrict xs, const float* __restrict ys,
                               const float* __restrict zs, std::size_t count, const WindowRules k,
                               float* __restrict low, float* __restrict high,
                               std::int32_t* __restrict cell, std::int32_t* __restrict in_slab) {
  const auto row = static_cast<std::int32_t>(k.cells);
  const float tall = k.layers > 0 ? 1 : 0, top = k.layers > 0 ? k.layers : 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = xs[i], y = ys[i], z = zs[i];
    const float above = k.slope_x * x + k.slope_y * y + k.slope_z * z + k.offset;
    const float dx = x - k.centre_x, dy = y - k.centre_y;
    const float wider = k.grade * std::sqrt(dx * dx + dy * dy);
    const float over = above - k.z_min + wider, under = k.z_max + wider - above;
    low[i] = over, high[i] = under;
    in_slab[i] = (over >= 0) & (under >= 0);

    const float up = z * tall;
    const std::int32_t inside =
        (x >= 0) & (y >= 0) & (up >= 0) & (x < k.cells) & (y < k.cells) & (up < top);
    const float sum = x + y + z;
    const std::int32_t finite = sum - sum == 0;  // not of infinities and what is no number
    const float kx = inside != 0 ? x : 0, ky = inside != 0 ? y : 0, kz = inside != 0 ? up : 0;
    const std::int32_t column = static_cast<std::int32_t>(ky) * row + static_cast<std::int32_t>(kx);
    const std::int32_t place = column * PlacedBlock::kLayers + static_cast<std::int32_t>(kz);
    const std::int32_t elsewhere = finite != 0 ? PlacedBlock::kOutside : PlacedBlock::kNotFinite;
    cell[i] = inside != 0 ? place : elsewhere;
  }
}

struct BlockCounts {
  std::int32_t hits = 0, not_finite = 0;
};

PERCEPTION_WIDER BlockCounts settleAll(const std::int32_t* __restrict cell,
                                       const std::int32_t* __restrict in_slab,
                                       const float* __restrict weights, std::size_t count,
                                       std::int32_t* __restrict settled) {
  BlockCounts sum;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t hit = (cell[i] >= 0) & in_slab[i];
    const std::int32_t full = hit & !(weights[i] < PlacedBlock::kFullWeight);
    settled[i] = full != 0 ? cell[i] : PlacedBlock::kOutside;
    sum.hits += hit;
    sum.not_finite += cell[i] == PlacedBlock::kNotFinite;
  }
  return sum;
}

constexpr PlacedBlock::Lane<float> allFull() {
  PlacedBlock::Lane<float> weights{};
  for (float& w : weights) w = 1;
  return weights;
}

}  // namespace

void PlacedBlock::chooseHits(std::size_t count, const float* weights, std::int32_t before) {
  static constexpr Lane<float> kAllFull = allFull();
  const BlockCounts sum = settleAll(cell.data(), in_slab.data(), weights ? weights : &kAllFull[0],
                                    count, settled.data());
  hits = static_cast<std::size_t>(sum.hits);
  not_finite = static_cast<std::size_t>(sum.not_finite);
  leaveOut(count, before);
}

void PlacedBlock::chooseClear(std::size_t count, std::int32_t before) {
  hits = 0;
  not_finite = static_cast<std::size_t>(
      std::count(cell.begin(), cell.begin() + static_cast<std::ptrdiff_t>(count), kNotFinite));
  std::copy_n(cell.begin(), count, settled.begin());
  leaveOut(count, before);
}

// Without branches: whether a cell is new is anybody's guess.
void PlacedBlock::leaveOut(std::size_t count, std::int32_t before) {
  chosen_count = 0;
  for (std::size_t k = 0; k < count; ++k) {
    chosen[chosen_count] = static_cast<std::uint16_t>(k);
    chosen_count += (cell[k] < 0) | (cell[k] != before) ? 1 : 0;
    before = settled[k];
  }
}

WindowFrame::WindowFrame(const GridParams& params, const Pose3& T_world_ground,
                         const CellIndex& first, int cells, int layers)
    : per_metre_(1 / params.resolution),
      corner_{params.resolution * static_cast<double>(first.x),
              params.resolution * static_cast<double>(first.y),
              params.resolution * static_cast<double>(first.z)} {
  const Vector3 corner(corner_[0], corner_[1], corner_[2]);
  const Vector3 centre = T_world_ground.translation() - corner;
  const Vector3 up = T_world_ground.linear().col(2), slope = up * params.resolution;
  rules_.slope_x = static_cast<float>(slope.x()), rules_.slope_y = static_cast<float>(slope.y());
  rules_.slope_z = static_cast<float>(slope.z());
  rules_.offset = static_cast<float>(-up.dot(centre));
  rules_.centre_x = static_cast<float>(centre.x() * per_metre_);
  rules_.centre_y = static_cast<float>(centre.y() * per_metre_);
  rules_.grade = static_cast<float>(params.grade * params.resolution);
  rules_.z_min = static_cast<float>(params.z_min), rules_.z_max = static_cast<float>(params.z_max);
  rules_.cells = static_cast<float>(cells), rules_.layers = static_cast<float>(layers);
}

void WindowFrame::place(const Vector3* points, std::size_t count, PlacedBlock& out) const {
  // The last ones from a copy, with room behind.
  const std::size_t whole = count > 4 ? (count - 1) / 4 * 4 : 0;
  toCells(points->data(), whole, corner_, per_metre_, out.x.data(), out.y.data(), out.z.data());
  double rest[13] = {};
  std::memcpy(rest, points[whole].data(), (count - whole) * sizeof(Vector3));
  toCells(rest, 4, corner_, per_metre_, &out.x[whole], &out.y[whole], &out.z[whole]);
  placeAll(out.x.data(), out.y.data(), out.z.data(), count, rules_, out.low.data(), out.high.data(),
           out.cell.data(), out.in_slab.data());
}

}  // namespace perception
