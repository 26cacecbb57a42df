#include "libperception/filter/likelihood/PairDensity.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/filter/state/FixedAxes.h"

namespace perception {
namespace {

constexpr double kLogTwoPi = 1.8378770664093454836;

template <int N>
Density gaussian(const Eigen::Matrix<double, N, 1>& y, const Eigen::Matrix<double, N, N>& S) {
  Density out;
  const FixedFactors<N> factors(S);
  if (!factors.positive()) return out;
  out.nis = factors.normSquared(y);
  out.log_density = -0.5 * (out.nis + std::log(factors.determinant()) + N * kLogTwoPi);
  return out;
}

Density gaussian(const AxisVector& y, const AxisMatrix& S) {
  Density out;
  withAxes(y.size(), [&](auto n) { out = gaussian<n>(fixedRows<n, 1>(y), fixedRows<n, n>(S)); });
  return out;
}

}  // namespace

Density densityOf(const Innovation& innovation, const ClassFilter& filter) {
  if (filter.modes.empty()) return gaussian(innovation.y, innovation.S);
  Density out;
  for (const auto& mode : filter.modes) {
    const Density d =
        gaussian(innovation.residualOf(mode, filter), innovation.covarianceOf(mode.P));
    out.log_density = logAddExp(out.log_density, mode.log_probability + d.log_density);
    out.nis = std::min(out.nis, d.nis);
  }
  return out;
}

void ExpectedAxes::set(const ClassFilter& f, const Kinematics& k, const AxisPrediction& p) {
  withAxes(p.h.size(), [&](auto n) {
    const Eigen::Matrix<double, n, 4> H = fixedRows<n, 5>(p.H_q) * k.J;
    const auto He = fixedRows<n, 2>(p.H_extent);
    const Vector2 extent_variance(f.extent.var_length, f.extent.var_width);
    const Eigen::Matrix<double, n, 2> spread = He * extent_variance.asDiagonal();
    fixedSquare<n>(S_) = H * f.P * H.transpose() + spread * He.transpose();
  });
  if (p.R_model.size() > 0) S_ += p.R_model;
  S_.diagonal().array() += 1e-9;  // keeps S invertible for any R (method.md 4)
}

Density ExpectedAxes::densityOf(const AxisPrediction& p, const Measurement& m, const AxisList& axes,
                                const std::vector<AxisKind>& kinds) const {
  Density out;
  withAxes(axes.count, [&](auto n) {
    Eigen::Matrix<double, n, 1> y;
    Eigen::Matrix<double, n, n> own;
    for (int r = 0; r < n; ++r) {
      const Eigen::Index a = axes.index[static_cast<std::size_t>(r)];
      const double d = m.z[a] - p.h[a];
      y[r] = kinds[static_cast<std::size_t>(a)] == AxisKind::kAngle ? wrapAngle(d) : d;
      for (int c = 0; c <= r; ++c) {
        const Eigen::Index b = axes.index[static_cast<std::size_t>(c)];
        own(r, c) = S_(a, b) + m.R(a, b);
      }
    }
    out = gaussian<n>(y, own);
  });
  return out;
}

}  // namespace perception
