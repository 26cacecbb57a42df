#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "libperception/simd/Vector8.h"

namespace perception {

PERCEPTION_LANES float leastOf(const Float4& v) {
  return std::min(std::min(v[0], v[1]), std::min(v[2], v[3]));
}
PERCEPTION_LANES float largestOf(const Float4& v) {
  return std::max(std::max(v[0], v[1]), std::max(v[2], v[3]));
}
PERCEPTION_LANES float sumOf(const Float4& v) { return (v[0] + v[1]) + (v[2] + v[3]); }

/// Points of the plane [m], one at least, in groups of four. The last group is filled up by the
/// last point, at weight 0.
struct PointFours {
  /// `at(i)`: a pair of x and y of point i < count.
  template <class At>
  PointFours(std::size_t count, const At& at) : groups((count + 3) / 4) {
    x.reserve(groups), y.reserve(groups), weight.reserve(groups);
    for (std::size_t i = 0; i < count; i += 4) {
      Float4 px{}, py{}, w{};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [ax, ay] = at(std::min(i + k, count - 1));
        px[k] = ax, py[k] = ay, w[k] = i + k < count ? 1.0f : 0.0f;
      }
      x.push_back(px), y.push_back(py), weight.push_back(w);
    }
  }

  std::size_t groups;
  std::vector<Float4> x, y, weight;
};

/// A direction for each group of four lanes of a vector: one of Float4, two of Float8.
template <class Float>
struct LaneDirections {
  static constexpr std::size_t kCount = sizeof(Float) / sizeof(Float4);

  PERCEPTION_LANES static Float of(const float* values) {
    if constexpr (kCount == 1) {
      return all<Float>(values[0]);
    } else {
      const float a = values[0], b = values[1];
      return Float{a, a, a, a, b, b, b, b};
    }
  }
  /// The same four numbers for each direction.
  PERCEPTION_LANES static Float same(const Float4& v) {
    if constexpr (kCount == 1) {
      return v;
    } else {
      return Float{v[0], v[1], v[2], v[3], v[0], v[1], v[2], v[3]};
    }
  }
  PERCEPTION_LANES static Float4 lanesOf(const Float& v, std::size_t direction) {
    if constexpr (kCount == 1) {
      return v;
    } else {
      return direction == 0 ? Float4{v[0], v[1], v[2], v[3]} : Float4{v[4], v[5], v[6], v[7]};
    }
  }
  /// What `reduce` makes of the four lanes of each direction, in all of them.
  template <class Reduce>
  PERCEPTION_LANES static Float reduced(const Float& v, const Reduce& reduce) {
    float values[kCount];
    for (std::size_t k = 0; k < kCount; ++k) values[k] = reduce(lanesOf(v, k));
    return of(values);
  }
};

/// Points along and across directions [m], and their bounds in every lane of a direction.
template <class Float>
struct TurnedPoints {
  using Directions = LaneDirections<Float>;
  static constexpr std::size_t kMost = 128;  ///< groups of four points

  /// `cosines`, `sines`: of the directions.
  PERCEPTION_LANES TurnedPoints(const PointFours& points, const float* cosines,
                                const float* sines) {
    const Float c = Directions::of(cosines), s = Directions::of(sines);
    constexpr float kFar = std::numeric_limits<float>::infinity();
    low_a = low_b = all<Float>(kFar), high_a = high_b = all<Float>(-kFar);
    std::size_t i = 0;
    do {
      const Float x = Directions::same(points.x[i]), y = Directions::same(points.y[i]);
      a[i] = c * x + s * y, b[i] = c * y - s * x;
      low_a = smaller(low_a, a[i]), high_a = larger(high_a, a[i]);
      low_b = smaller(low_b, b[i]), high_b = larger(high_b, b[i]);
    } while (++i < points.groups);
    low_a = leastOfEach(low_a), high_a = largestOfEach(high_a);
    low_b = leastOfEach(low_b), high_b = largestOfEach(high_b);
  }

  Float a[kMost], b[kMost];
  Float low_a, high_a, low_b, high_b;

 private:
  PERCEPTION_LANES static Float leastOfEach(const Float& v) {
    return Directions::reduced(v, [](const Float4& lanes) { return leastOf(lanes); });
  }
  PERCEPTION_LANES static Float largestOfEach(const Float& v) {
    return Directions::reduced(v, [](const Float4& lanes) { return largestOf(lanes); });
  }
};

}  // namespace perception
