#include "libperception/lidar/segments/ReturnDirections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Median.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {
namespace {

/// Without branches, so that the compiler vectorizes it.
PERCEPTION_WIDEST void directAll(const float* __restrict x, const float* __restrict y,
                                 const float* __restrict height, std::size_t count, float sx,
                                 float sy, float sz, float* __restrict azimuth,
                                 float* __restrict elevation) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - sx, dy = y[i] - sy, dz = height[i] - sz;
    azimuth[i] = closeAtan2(dx, dy);
    elevation[i] = closeAtan2(std::sqrt(dx * dx + dy * dy), dz);
  }
}

/// The smallest step in azimuth from a return to another of its beam and group; `none` if there is
/// no such return nearer than that.
float stepFrom(std::uint32_t from, const ReturnGroup& group, const ReturnDirections& directions,
               float none) {
  constexpr auto kSameBeam = static_cast<float>(radians(0.04)),
                 kSameColumn = static_cast<float>(radians(0.05)),
                 kTurn = static_cast<float>(kTwoPi);
  float least = none;
  for (const std::uint32_t to : group) {
    if (std::abs(directions.elevation[to] - directions.elevation[from]) > kSameBeam) continue;
    const float off = std::abs(directions.azimuth[to] - directions.azimuth[from]);
    const float step = std::min(off, kTurn - off);
    if (step > kSameColumn) least = std::min(least, step);
  }
  return least;
}

}  // namespace

ReturnDirections::ReturnDirections(const ReturnPlaces& places, const Vector3& sensor)
    : azimuth(places.x.size()), elevation(places.x.size()) {
  directAll(places.x.data(), places.y.data(), places.height.data(), places.x.size(),
            static_cast<float>(sensor.x()), static_cast<float>(sensor.y()),
            static_cast<float>(sensor.z()), azimuth.data(), elevation.data());
}

double azimuthStep(const ReturnDirections& directions, const std::vector<ReturnGroup>& groups) {
  constexpr std::size_t kLargeGroup = 40, kSamples = 64, kLeastSamples = 12;
  constexpr auto kMost = static_cast<float>(radians(1.5));
  std::size_t large = 0;
  for (const ReturnGroup& group : groups) large += group.size() >= kLargeGroup;
  if (large == 0) return 0;
  const std::size_t of_each = 1 + kSamples / large;
  std::vector<float> steps;
  for (const ReturnGroup& group : groups) {
    if (group.size() < kLargeGroup) continue;
    for (std::size_t k = 0; k < of_each; ++k) {
      const std::uint32_t from = group[(2 * k + 1) * group.size() / (2 * of_each)];
      const float step = stepFrom(from, group, directions, kMost);
      if (step < kMost) steps.push_back(step);
    }
    if (steps.size() >= kSamples) break;
  }
  if (steps.size() < kLeastSamples) return 0;
  return static_cast<double>(medianOf(std::move(steps)));
}

}  // namespace perception
