#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "libperception/lidar/description/ClusterDescriptor.h"

namespace perception {

/// Feature f, or one of those that follow it.
inline float& at(Descriptor& d, Feature f, int offset = 0) {
  return d[static_cast<std::size_t>(f) + static_cast<std::size_t>(offset)];
}

/// The span of some values.
struct Interval {
  float low = 1e30f, high = -1e30f;
  void add(float v) { low = std::min(low, v), high = std::max(high, v); }
  float size() const { return high > low ? high - low : 0; }
};

/// The value of that rank; changes the order.
inline float quantile(std::vector<float>& values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

}  // namespace perception
