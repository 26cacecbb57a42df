#pragma once
#include <cstddef>

namespace perception::python {

/// Rows of three numbers one after another, as three columns. The columns do not overlap the rows.
void splitRows(const float* rows, std::size_t count, float* x, float* y, float* z);

/// The largest distance of the numbers from 0; NaN counts as none.
float farthestOf(const float* numbers, std::size_t count);

}  // namespace perception::python
