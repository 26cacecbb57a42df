#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {

/// A scalar with its variance.
struct ScalarEstimate {
  double mean = 0, variance = 1;
};

/// Kalman update of x by a direct measurement z of it. The update takes the variance of x no lower
/// than `floor`, where errors of successive measurements are not independent.
inline void scalarUpdate(const ScalarEstimate& z, ScalarEstimate& x, double floor = 0) {
  const double gain = x.variance / (x.variance + z.variance);
  x.mean += gain * (z.mean - x.mean);
  x.variance = std::max(std::min(x.variance, floor), x.variance * (1 - gain));
}

/// Removes what rounding leaves between P and its transpose.
template <int N>
void symmetrize(Eigen::Matrix<double, N, N>& P) {
  P = (0.5 * (P + P.transpose())).eval();
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

  bool positive() const { return positive_; }  ///< false: S was no covariance, nothing else holds
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

/// Kalman update of a Gaussian (x, P) of N states by the innovation y of n axes in Joseph form
/// (method.md 4): H [n x N] the measurement's Jacobian, R its noise, S = H P H' + R. Angles among
/// the states are wrapped by the caller. Returns log N(y; 0, S) up to a constant that depends on n.
/// If S is not a covariance, returns minus infinity and leaves x and P unchanged.
template <int n, int N>
double josephUpdate(const Eigen::Matrix<double, n, 1>& y, const Eigen::Matrix<double, n, N>& H,
                    const Eigen::Matrix<double, n, n>& R, const Eigen::Matrix<double, n, n>& S,
                    Eigen::Matrix<double, N, 1>& x, Eigen::Matrix<double, N, N>& P) {
  using Square = Eigen::Matrix<double, N, N>;
  const FixedFactors<n> factors(S);
  if (!factors.positive()) return -std::numeric_limits<double>::infinity();
  const Eigen::Matrix<double, n, N> HP = H * P;
  const Eigen::Matrix<double, N, n> K = factors.template solve<N>(HP).transpose();
  const Square I_KH = Square::Identity() - K * H;
  x += K * y;
  P = (I_KH * P * I_KH.transpose() + K * R * K.transpose()).eval();
  symmetrize(P);
  return -0.5 * (factors.normSquared(y) + std::log(factors.determinant()));
}

/// The same of a scalar measurement: y its residual, h' = dz/dx.
template <int N>
double josephUpdate(double y, double variance, const Eigen::Matrix<double, 1, N>& h,
                    Eigen::Matrix<double, N, 1>& x, Eigen::Matrix<double, N, N>& P) {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  const Scalar R(variance), S = h * P * h.transpose() + R;
  return josephUpdate<1, N>(Scalar(y), h, R, S, x, P);
}

}  // namespace perception
