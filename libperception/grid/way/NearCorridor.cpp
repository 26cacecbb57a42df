#include "libperception/grid/way/NearCorridor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "libperception/core/Frames.h"
#include "libperception/simd/Compress.h"
#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

constexpr double kBentLeast = 1e-6;  // [1/m] below it the arc is a line

/// A place as seen from the center of the arc, if it bends; a right turn is a mirrored left turn.
struct FromCenter {
  bool straight;
  double x, y;                     ///< [m] in the direction of travel
  double side, radius, to_center;  ///< [-] of the turn; [m], [m] of the place

  FromCenter(const Corridor& corridor, double ego_x, double ego_y)
      : straight(std::abs(corridor.curvature) < kBentLeast),
        x(corridor.backward ? -ego_x : ego_x),
        y(corridor.backward ? -ego_y : ego_y),
        side(corridor.curvature > 0 ? 1 : -1),
        radius(1 / std::abs(corridor.curvature)),
        to_center(radius - side * y) {}
  double s() const { return straight ? x : radius * std::atan2(x, to_center); }
  double d() const {
    return straight ? y : side * (radius - std::sqrt(x * x + to_center * to_center));
  }
};

/// Bounds on points given from a base, along and across the direction of travel.
struct CorridorBounds {
  float along[4], across[4];  ///< rows of the transform from the base: factors and offset [m]
  float bend;                 ///< [1/m] half the curvature
  float reach2;               ///< [m^2] from the ego origin
  float side, side_slope;     ///< [m], [-] largest |y - bend r^2|: side + side_slope r
};

CorridorBounds boundsOf(const Corridor& corridor, double end, const Vector3& base) {
  constexpr double kSlack = 0.05;  // [m] more than floats round within the reach
  const double travel = corridor.backward ? -1 : 1, half = corridor.width / 2 + kSlack;
  const double reach = std::max(end, 0.0) + half + kSlack;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  const Vector3 offset = T_ego_world * base;
  CorridorBounds bounds{};
  for (int i = 0; i < 3; ++i) {
    bounds.along[i] = static_cast<float>(travel * T_ego_world.linear()(0, i));
    bounds.across[i] = static_cast<float>(travel * T_ego_world.linear()(1, i));
  }
  bounds.along[3] = static_cast<float>(travel * offset.x());
  bounds.across[3] = static_cast<float>(travel * offset.y());
  bounds.bend = static_cast<float>(corridor.curvature / 2);
  bounds.reach2 = static_cast<float>(reach * reach);
  bounds.side = static_cast<float>(half);
  bounds.side_slope = static_cast<float>(half * std::abs(corridor.curvature) / 2);
  return bounds;
}

/// Without branches, so that the compiler vectorizes it; false for NaN.
PERCEPTION_WIDER void markNear(const float* __restrict x, const float* __restrict y,
                               const float* __restrict z, std::size_t count,
                               const CorridorBounds& bounds, std::int32_t* __restrict marks) {
  const CorridorBounds b = bounds;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = b.along[0] * x[i] + b.along[1] * y[i] + b.along[2] * z[i] + b.along[3];
    const float v = b.across[0] * x[i] + b.across[1] * y[i] + b.across[2] * z[i] + b.across[3];
    const float r2 = u * u + v * v;
    const float side = b.side + b.side_slope * std::sqrt(r2);
    marks[i] = (r2 <= b.reach2) & (std::abs(v - b.bend * r2) <= side);
  }
}

}  // namespace

std::vector<std::uint32_t> nearCorridor(const Corridor& corridor, double end,
                                        const GridPoints& points) {
  constexpr std::size_t kBlock = 512;  // points that fit in the L1 cache
  std::array<std::int32_t, kBlock> marks;
  std::array<std::uint32_t, kBlock + kPackSlack> places;
  const CorridorBounds bounds = boundsOf(corridor, end, points.base());
  std::vector<std::uint32_t> near;
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - first);
    markNear(points.x(first), points.y(first), points.z(first), count, bounds, marks.data());
    const std::size_t found =
        packPlaces(marks.data(), count, static_cast<std::uint32_t>(first), places.data());
    near.insert(near.end(), places.begin(), places.begin() + static_cast<std::ptrdiff_t>(found));
  }
  return near;
}

std::optional<ArcPlace> arcPlaceWithin(const Corridor& corridor, double x, double y, double side) {
  const FromCenter place(corridor, x, y);
  const double d = place.d();
  if (std::abs(d) > side) return std::nullopt;
  return ArcPlace{place.s(), d};
}

double alongArc(const Corridor& corridor, double x, double y) {
  return FromCenter(corridor, x, y).s();
}

}  // namespace perception
