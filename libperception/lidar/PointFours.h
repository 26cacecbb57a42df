#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace perception {

/// Four floats in one SSE register.
using Four = float __attribute__((vector_size(16)));

inline Four least(Four a, Four b) { return a < b ? a : b; }
inline Four largest(Four a, Four b) { return a > b ? a : b; }
inline Four all(float v) { return Four{v, v, v, v}; }
inline float leastOf(Four v) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }
inline float largestOf(Four v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
inline float sumOf(Four v) { return (v[0] + v[1]) + (v[2] + v[3]); }

/// Points of the plane [m] in groups of four. The last group is filled up by the last point, at
/// weight 0.
struct PointFours {
  /// `at(i)`: a pair of x and y of point i < count.
  template <class At>
  PointFours(std::size_t count, const At& at) {
    const std::size_t groups = (count + 3) / 4;
    x.reserve(groups), y.reserve(groups), weight.reserve(groups);
    for (std::size_t i = 0; i < count; i += 4) {
      Four px{}, py{}, w{};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [ax, ay] = at(std::min(i + k, count - 1));
        px[k] = ax, py[k] = ay, w[k] = i + k < count ? 1.0f : 0.0f;
      }
      x.push_back(px), y.push_back(py), weight.push_back(w);
    }
    a.resize(groups), b.resize(groups);
  }

  /// Sets a and b: the points along and across the direction of that cosine and sine.
  void turn(float cosine, float sine) {
    const Four c = all(cosine), s = all(sine);
    for (std::size_t i = 0; i < x.size(); ++i)
      a[i] = c * x[i] + s * y[i], b[i] = c * y[i] - s * x[i];
  }

  std::vector<Four> x, y, weight;
  std::vector<Four> a, b;  ///< after turn()
};

/// The bounds of groups of four [m], in every lane; of at least one group.
struct FourBounds {
  Four low, high;
  explicit FourBounds(const std::vector<Four>& values) : low(values[0]), high(values[0]) {
    for (const Four v : values) low = least(low, v), high = largest(high, v);
    low = all(leastOf(low)), high = all(largestOf(high));
  }
  float size() const { return high[0] - low[0]; }
};

}  // namespace perception
