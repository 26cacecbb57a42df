#include "libperception/python/arrays/ColumnCopies.h"

#include <array>
#include <cmath>

namespace perception::python {

void splitRows(const float* rows, std::size_t count, float* __restrict x, float* __restrict y,
               float* __restrict z) {
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = rows[3 * i];
    y[i] = rows[3 * i + 1];
    z[i] = rows[3 * i + 2];
  }
}

float farthestOf(const float* numbers, std::size_t count) {
  // Several at once: one maximum after the other would wait for the one before.
  std::array<float, 8> most{};
  std::size_t i = 0;
  for (; i + most.size() <= count; i += most.size()) {
    for (std::size_t k = 0; k < most.size(); ++k) {
      const float distance = std::abs(numbers[i + k]);
      most[k] = distance > most[k] ? distance : most[k];
    }
  }
  for (; i < count; ++i) {
    const float distance = std::abs(numbers[i]);
    most[0] = distance > most[0] ? distance : most[0];
  }
  for (const float one : most) most[0] = one > most[0] ? one : most[0];
  return most[0];
}

}  // namespace perception::python
