#include "libperception/grid/beams/WindowFrame.h"

#include <algorithm>
#include <cmath>

#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

// Returns how many are not finite.
PERCEPTION_WIDER std::int32_t placeAll(const float* __restrict xs, const float* __restrict ys,
                                       const float* __restrict zs, std::size_t count,
                                       const PointOffset from, const WindowRules k,
                                       float* __restrict out_x, float* __restrict out_y,
                                       float* __restrict out_z, float* __restrict low,
                                       float* __restrict high, std::int32_t* __restrict cell,
                                       std::int32_t* __restrict in_slab) {
  const auto row = static_cast<std::int32_t>(k.cells);
  std::int32_t not_finite = 0;
  const float tall = k.layers > 0 ? 1 : 0, top = k.layers > 0 ? k.layers : 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = xs[i] * from.per_meter + from.x;
    const float y = ys[i] * from.per_meter + from.y;
    const float z = zs[i] * from.per_meter + from.z;
    out_x[i] = x, out_y[i] = y, out_z[i] = z;
    const float above = k.slope_x * x + k.slope_y * y + k.slope_z * z + k.offset;
    const float dx = x - k.center_x, dy = y - k.center_y;
    const float wider = k.grade * std::sqrt(dx * dx + dy * dy);
    const float over = above - k.z_min + wider, under = k.z_max + wider - above;
    low[i] = over, high[i] = under;
    in_slab[i] = (over >= 0) & (under >= 0);

    const float up = z * tall;
    const std::int32_t inside =
        (x >= 0) & (y >= 0) & (up >= 0) & (x < k.cells) & (y < k.cells) & (up < top);
    const float sum = x + y + z;
    const std::int32_t finite = sum - sum == 0;  // false for infinities and NaN
    const float kx = inside != 0 ? x : 0, ky = inside != 0 ? y : 0, kz = inside != 0 ? up : 0;
    const std::int32_t column = static_cast<std::int32_t>(ky) * row + static_cast<std::int32_t>(kx);
    const std::int32_t place = column * PlacedBlock::kLayers + static_cast<std::int32_t>(kz);
    const std::int32_t elsewhere = finite != 0 ? PlacedBlock::kOutside : PlacedBlock::kNotFinite;
    cell[i] = inside != 0 ? place : elsewhere;
    not_finite += 1 - finite;
  }
  return not_finite;
}

// Returns how many are hits.
PERCEPTION_WIDER std::int32_t settleAll(const std::int32_t* __restrict cell,
                                        const std::int32_t* __restrict in_slab,
                                        const float* __restrict weights, std::size_t count,
                                        std::int32_t* __restrict settled) {
  std::int32_t hits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t hit = (cell[i] >= 0) & in_slab[i];
    const std::int32_t full = hit & !(weights[i] < PlacedBlock::kFullWeight);
    settled[i] = full != 0 ? cell[i] : PlacedBlock::kOutside;
    hits += hit;
  }
  return hits;
}

// From the second point on.
PERCEPTION_WIDER void findNews(const std::int32_t* __restrict cell,
                               const std::int32_t* __restrict settled, std::size_t count,
                               std::uint8_t* __restrict news) {
  for (std::size_t i = 1; i < count; ++i) news[i] = (cell[i] < 0) | (cell[i] != settled[i - 1]);
}

constexpr PlacedBlock::Lane<float> allFull() {
  PlacedBlock::Lane<float> weights{};
  for (float& w : weights) w = 1;
  return weights;
}

}  // namespace

void PlacedBlock::chooseHits(std::size_t count, const float* weights, std::int32_t before) {
  static constexpr Lane<float> kAllFull = allFull();
  hits = static_cast<std::size_t>(settleAll(
      cell.data(), in_slab.data(), weights ? weights : &kAllFull[0], count, settled.data()));
  leaveOut(count, before);
}

void PlacedBlock::chooseClear(std::size_t count, std::int32_t before) {
  std::copy_n(cell.begin(), count, settled.begin());
  leaveOut(count, before);
}

void PlacedBlock::leaveOut(std::size_t count, std::int32_t before) {
  std::uint8_t news[kSize] = {};
  news[0] = cell[0] < 0 || cell[0] != before;
  findNews(cell.data(), settled.data(), count, news);
  chosen.find(news, kSize);
}

WindowFrame::WindowFrame(const GridParams& params, const Pose3& T_world_ground,
                         const CellIndex& first, int cells, int layers)
    : per_meter_(1 / params.resolution),
      corner_{params.resolution * static_cast<double>(first.x),
              params.resolution * static_cast<double>(first.y),
              params.resolution * static_cast<double>(first.z)} {
  const Vector3 corner(corner_[0], corner_[1], corner_[2]);
  const Vector3 center = T_world_ground.translation() - corner;
  const Vector3 up = T_world_ground.linear().col(2), slope = up * params.resolution;
  rules_.slope_x = static_cast<float>(slope.x()), rules_.slope_y = static_cast<float>(slope.y());
  rules_.slope_z = static_cast<float>(slope.z());
  rules_.offset = static_cast<float>(-up.dot(center));
  rules_.center_x = static_cast<float>(center.x() * per_meter_);
  rules_.center_y = static_cast<float>(center.y() * per_meter_);
  rules_.grade = static_cast<float>(params.grade * params.resolution);
  rules_.z_min = static_cast<float>(params.z_min), rules_.z_max = static_cast<float>(params.z_max);
  rules_.cells = static_cast<float>(cells), rules_.layers = static_cast<float>(layers);
}

void WindowFrame::place(const GridPoints& points, std::size_t first, std::size_t count,
                        PlacedBlock& out) const {
  const std::int32_t not_finite =
      placeAll(points.x(first), points.y(first), points.z(first), count, offsetOf(points), rules_,
               out.x.data(), out.y.data(), out.z.data(), out.low.data(), out.high.data(),
               out.cell.data(), out.in_slab.data());
  out.not_finite = static_cast<std::size_t>(not_finite);
}

PointOffset WindowFrame::offsetOf(const GridPoints& points) const {
  const auto at = [&](int axis) {
    return static_cast<float>((points.base()[axis] - corner_[axis]) * per_meter_);
  };
  return {at(0), at(1), at(2), static_cast<float>(per_meter_)};
}

WindowPlace WindowFrame::place(const Vector3& point) const {
  GridPoints one;
  one.push_back(point);
  PlacedBlock placed;
  place(one, 0, 1, placed);
  return placed.at(0);
}

int windowLayers(const GridParams& params) {
  constexpr int kGroup = 4, kMost = 64;  // as LogOddsColumn and WindowMarks have them
  const double spread = 2 * params.grade * params.size * std::sqrt(0.5);
  const double layers = (params.z_max - params.z_min + spread) / params.resolution;
  return std::min(kMost, kGroup * static_cast<int>(std::ceil((layers - 1e-6) / kGroup)));
}

CellIndex windowCorner(const GridParams& params, const Vector3& center) {
  const auto cells = static_cast<std::int64_t>(std::ceil(params.size / params.resolution));
  const double below = params.grade * params.size * std::sqrt(0.5) - params.z_min;
  const auto index = [&](double v) {
    return static_cast<std::int64_t>(std::floor(v / params.resolution));
  };
  return {index(center.x()) - cells / 2, index(center.y()) - cells / 2,
          index(center.z() - below + 1e-9)};
}

}  // namespace perception
