#pragma once
#include <cassert>
#include <type_traits>

#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// f(std::integral_constant<int, n>) for n axes, 1 to kMaxAxes: products and factorizations of
/// small matrices are several times faster with sizes known at compile time.
template <class Function>
void withAxes(Eigen::Index n, const Function& f) {
  static_assert(kMaxAxes == 5);
  switch (n) {
    case 1:
      return f(std::integral_constant<int, 1>{});
    case 2:
      return f(std::integral_constant<int, 2>{});
    case 3:
      return f(std::integral_constant<int, 3>{});
    case 4:
      return f(std::integral_constant<int, 4>{});
    case 5:
      return f(std::integral_constant<int, 5>{});
    default:
      assert(n == 0);
  }
}

/// Fixed-size view of a matrix with N rows.
template <int N, int kColumns, class Matrix>
auto fixedRows(const Matrix& m) {
  assert(m.rows() == N);
  return Eigen::Map<const Eigen::Matrix<double, N, kColumns>>(m.data());
}

/// Fixed-size writable view, N x N.
template <int N>
auto fixedSquare(AxisMatrix& m) {
  m.resize(N, N);
  return Eigen::Map<Eigen::Matrix<double, N, N>>(m.data());
}

}  // namespace perception
