#include "libperception/grid/WindowFrame.h"

#include <cmath>

#include "libperception/core/Wider.h"

namespace perception {
namespace {

/// The constants of placeAll(), as in WindowFrame.
struct Constants {
  double per_metre, corner_x, corner_y, corner_z, slope_x, slope_y, slope_z, offset;
  double centre_x, centre_y;
  float z_min, z_max, grade, cells, layers;
};

// Doubles as far as places of the world go, floats from the window's corner on.
PERCEPTION_WIDER void placeAll(const double* __restrict xyz, std::size_t count, const Constants& c,
                               PlacedBlock& out) {
  float* __restrict ox = out.x.data(), * __restrict oy = out.y.data(), * __restrict oz = out.z.data();
  float* __restrict low = out.low.data(), * __restrict high = out.high.data();
  const Constants k = c;
  for (std::size_t i = 0; i < count; ++i) {
    const double px = xyz[3 * i], py = xyz[3 * i + 1], pz = xyz[3 * i + 2];
    ox[i] = static_cast<float>((px - k.corner_x) * k.per_metre);
    oy[i] = static_cast<float>((py - k.corner_y) * k.per_metre);
    oz[i] = static_cast<float>((pz - k.corner_z) * k.per_metre);
    const auto above =
        static_cast<float>(k.slope_x * px + k.slope_y * py + k.slope_z * pz + k.offset);
    const auto dx = static_cast<float>(px - k.centre_x), dy = static_cast<float>(py - k.centre_y);
    const float wider = k.grade * std::sqrt(dx * dx + dy * dy);
    low[i] = above - k.z_min + wider;
    high[i] = k.z_max + wider - above;
  }
}

PERCEPTION_WIDER void findCells(std::size_t count, float cells, float layers, PlacedBlock& out) {
  const float* __restrict x = out.x.data(), * __restrict y = out.y.data();
  const float* __restrict z = out.z.data(), * __restrict low = out.low.data();
  const float* __restrict high = out.high.data();
  std::int32_t* __restrict cell = out.cell.data(), * __restrict in_slab = out.in_slab.data();
  const auto row = static_cast<std::int32_t>(cells);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t inside =
        (x[i] >= 0) & (y[i] >= 0) & (z[i] >= 0) & (x[i] < cells) & (y[i] < cells) & (z[i] < layers);
    const float sum = x[i] + y[i] + z[i];
    const std::int32_t finite = sum - sum == 0;  // not of infinities and what is no number
    const float kx = inside != 0 ? x[i] : 0, ky = inside != 0 ? y[i] : 0;
    const float kz = inside != 0 ? z[i] : 0;
    const std::int32_t place =
        (static_cast<std::int32_t>(ky) * row + static_cast<std::int32_t>(kx)) *
            PlacedBlock::kLayers +
        static_cast<std::int32_t>(kz);
    const std::int32_t elsewhere = finite != 0 ? PlacedBlock::kOutside : PlacedBlock::kNotFinite;
    cell[i] = inside != 0 ? place : elsewhere;
    in_slab[i] = (low[i] >= 0) & (high[i] >= 0);
  }
}

}  // namespace

WindowFrame::WindowFrame(const GridParams& params, const Pose3& T_world_ground,
                         const CellIndex& first, int cells, int layers)
    : per_metre_(1 / params.resolution),
      corner_x_(params.resolution * static_cast<double>(first.x)),
      corner_y_(params.resolution * static_cast<double>(first.y)),
      corner_z_(params.resolution * static_cast<double>(first.z)),
      centre_x_(T_world_ground.translation().x()),
      centre_y_(T_world_ground.translation().y()),
      z_min_(static_cast<float>(params.z_min)),
      z_max_(static_cast<float>(params.z_max)),
      grade_(static_cast<float>(params.grade)),
      cells_(static_cast<float>(cells)),
      layers_(static_cast<float>(layers)) {
  const Vector3 up = T_world_ground.linear().col(2);
  slope_x_ = up.x(), slope_y_ = up.y(), slope_z_ = up.z();
  offset_ = -up.dot(T_world_ground.translation());
}

void WindowFrame::place(const Vector3* points, std::size_t count, PlacedBlock& out) const {
  placeAll(points->data(), count,
           {per_metre_, corner_x_, corner_y_, corner_z_, slope_x_, slope_y_, slope_z_, offset_,
            centre_x_, centre_y_, z_min_, z_max_, grade_, cells_, layers_},
           out);
  findCells(count, cells_, layers_, out);
}

}  // namespace perception
