#include "libperception/lidar/outline/EdgeFit.h"

#include <array>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

/// Cosines and sines of a quarter turn.
struct QuarterTurn {
  static constexpr std::size_t kCount = 30;
  std::array<float, kCount> cosine, sine;
  QuarterTurn() {
    for (std::size_t k = 0; k < kCount; ++k) {
      const double angle = radians(3) * static_cast<double>(k);
      cosine[k] = static_cast<float>(std::cos(angle)),
      sine[k] = static_cast<float>(std::sin(angle));
    }
  }
};

/// How points lie along the sides of the rectangle about them in a direction.
struct SidesFit {
  float closeness;        ///< sum of 1 / distance to the nearest side, at least 5 cm
  float distance, close;  ///< as in EdgeFit
  bool lengthwise;        ///< the longer side is along
};

/// One for each direction of `Float`.
template <class Float>
PERCEPTION_LANES void fitSides(const PointFours& points, const float* cosines, const float* sines,
                               SidesFit* fits) {
  using Directions = LaneDirections<Float>;
  const TurnedPoints<Float> turned(points, cosines, sines);
  Float closeness{}, distance{}, close{};
  for (std::size_t i = 0; i < points.groups; ++i) {
    const Float off_a = smaller<Float>(turned.a[i] - turned.low_a, turned.high_a - turned.a[i]);
    const Float off_b = smaller<Float>(turned.b[i] - turned.low_b, turned.high_b - turned.b[i]);
    const Float edge = smaller(off_a, off_b), w = Directions::same(points.weight[i]);
    closeness += w / larger(edge, all<Float>(0.05f));
    distance += w * edge, close += edge < all<Float>(0.12f) ? w : Float{};
  }
  for (std::size_t k = 0; k < Directions::kCount; ++k) {
    const std::size_t lane = 4 * k;
    const float along = turned.high_a[lane] - turned.low_a[lane],
                across = turned.high_b[lane] - turned.low_b[lane];
    fits[k] = {sumOf(Directions::lanesOf(closeness, k)), sumOf(Directions::lanesOf(distance, k)),
               sumOf(Directions::lanesOf(close, k)), along >= across};
  }
}

// In two directions. Like PERCEPTION_WIDER, with vectors of the width of each target.
PERCEPTION_TARGET("default")
void fitTwo(const PointFours& points, const float* cosines, const float* sines, SidesFit* fits) {
  for (std::size_t k = 0; k < 2; ++k) fitSides<Float4>(points, cosines + k, sines + k, fits + k);
}
#if PERCEPTION_HAS_WIDER
PERCEPTION_TARGET("avx2")
void fitTwo(const PointFours& points, const float* cosines, const float* sines, SidesFit* fits) {
  fitSides<Float8>(points, cosines, sines, fits);
}
#endif

}  // namespace

EdgeFit fitEdges(const PointFours& points) {
  static const QuarterTurn turn;
  EdgeFit best;
  float closeness = -1;
  for (std::size_t first = 0; first < QuarterTurn::kCount; first += 2) {
    std::array<SidesFit, 2> fits;
    fitTwo(points, &turn.cosine[first], &turn.sine[first], fits.data());
    for (std::size_t k = first; k < first + 2; ++k) {
      const SidesFit& fit = fits[k - first];
      if (fit.closeness <= closeness) continue;
      closeness = fit.closeness;
      const float c = turn.cosine[k], s = turn.sine[k];
      best = {fit.lengthwise ? c : -s, fit.lengthwise ? s : c, fit.distance, fit.close};
    }
  }
  return best;
}

}  // namespace perception
