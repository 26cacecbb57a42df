#pragma once
#include <cassert>
#include <type_traits>

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

/// S = L D L' of a covariance, L of unit diagonal: no square roots.
template <int N>
class FixedFactors {
 public:
  explicit FixedFactors(Eigen::Matrix<double, N, N> S) : L_(S) {
    for (int i = 0; i < N; ++i) {
      const double d = D_[i] = L_(i, i);
      if (!(d > 0)) return;
      for (int r = i + 1; r < N; ++r) {
        const double l = L_(r, i) / d;
        for (int c = i + 1; c <= r; ++c) L_(r, c) -= l * L_(c, i);
      }
      for (int r = i + 1; r < N; ++r) L_(r, i) /= d;
    }
    positive_ = true;
  }

  bool positive() const {
    return positive_;
  }  ///< false: S is not positive definite and the other members are invalid
  double determinant() const { return D_.prod(); }
  /// y' S^-1 y.
  double normSquared(Eigen::Matrix<double, N, 1> y) const {
    double sum = 0;
    for (int i = 0; i < N; ++i) {
      for (int r = i + 1; r < N; ++r) y[r] -= L_(r, i) * y[i];
      sum += y[i] * y[i] / D_[i];
    }
    return sum;
  }
  /// S^-1 B.
  template <int kColumns>
  Eigen::Matrix<double, N, kColumns> solve(Eigen::Matrix<double, N, kColumns> B) const {
    for (int i = 0; i < N; ++i)
      for (int r = i + 1; r < N; ++r) B.row(r) -= L_(r, i) * B.row(i);
    for (int i = N - 1; i >= 0; --i) {
      B.row(i) /= D_[i];
      for (int r = i + 1; r < N; ++r) B.row(i) -= L_(r, i) * B.row(r);
    }
    return B;
  }

 private:
  Eigen::Matrix<double, N, N> L_;  ///< below the diagonal
  Eigen::Matrix<double, N, 1> D_;
  bool positive_ = false;
};

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
