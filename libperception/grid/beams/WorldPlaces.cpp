#include "libperception/grid/beams/WorldPlaces.h"

#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

/// Without branches, so that the compiler vectorizes it; by hand, for Eigen calls a function.
PERCEPTION_WIDEST void moveAll(const float* __restrict x, const float* __restrict y,
                               const float* __restrict z, std::size_t count, const double* row,
                               double offset, double* __restrict moved) {
  const double a = row[0], b = row[1], c = row[2];
  for (std::size_t i = 0; i < count; ++i)
    moved[i] = a * static_cast<double>(x[i]) + b * static_cast<double>(y[i]) +
               c * static_cast<double>(z[i]) + offset;
}

}  // namespace

void WorldPlaces::place(const Pose3& T_world_ego, const float* ego_x, const float* ego_y,
                        const float* ego_z, std::size_t count) {
  double* const moved[] = {x.data(), y.data(), z.data()};
  for (int k = 0; k < 3; ++k) {
    const Vector3 row = T_world_ego.linear().row(k);
    moveAll(ego_x, ego_y, ego_z, count, row.data(), T_world_ego.translation()[k], moved[k]);
  }
}

}  // namespace perception
