#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace perception {

/// The middle one of one value or more; of an even number the upper one of the two in the middle.
template <class Value>
Value medianOf(std::vector<Value> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace perception
