#include "libperception/filter/likelihood/Innovation.h"

#include <array>

#include "libperception/core/math/Angle.h"
#include "libperception/filter/state/FixedAxes.h"

namespace perception {
namespace {

/// Takes from H_extent of the axes that tell a size what its nearness does to them: with a center
/// that stays, a longer vehicle is nearer and so looks wider, but how near it is the range tells
/// (method.md 5.13).
void atSeenRange(const AxisPrediction& prediction, const std::array<Eigen::Index, kMaxAxes>& axis,
                 AxisMask tell, decltype(Innovation::H_extent)& H_extent) {
  const auto tells = [&](Eigen::Index row) {
    return (tell >> axis[static_cast<std::size_t>(row)] & 1) != 0;
  };
  const auto shifted = [&](Eigen::Index row) {
    return prediction.H_q.row(axis[static_cast<std::size_t>(row)]).head<2>();
  };
  for (Eigen::Index r = 0; r < H_extent.rows(); ++r) {
    if (tells(r)) continue;
    const double size = shifted(r).squaredNorm();
    if (size <= 0) continue;
    for (Eigen::Index i = 0; i < H_extent.rows(); ++i)
      if (tells(i)) H_extent.row(i) -= shifted(i).dot(shifted(r)) / size * H_extent.row(r);
  }
}

}  // namespace

Innovation innovationOf(const ClassFilter& filter, const Kinematics& kinematics,
                        const AxisPrediction& prediction, const Measurement& m,
                        const MeasurementModel& model) {
  Innovation out;
  out.y = residual(model, m, prediction.h);
  const auto n = out.y.size();
  out.H.resize(n, 4);
  out.R.resize(n, n);
  auto& H_extent = out.H_extent;
  H_extent.resize(n, 2);
  std::array<Eigen::Index, kMaxAxes> axis{};
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < model.axes().size(); ++i) {
    if (m.seen >> i & 1) axis[static_cast<std::size_t>(row++)] = static_cast<Eigen::Index>(i);
  }
  const bool has_model_noise = prediction.R_model.size() > 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto a = axis[static_cast<std::size_t>(i)];
    out.H.row(i) = prediction.H_q.row(a) * kinematics.J;
    H_extent.row(i) = prediction.H_extent.row(a);
    for (Eigen::Index k = 0; k <= i; ++k) {
      const auto b = axis[static_cast<std::size_t>(k)];
      const double extent = H_extent(i, 0) * filter.extent.var_length * H_extent(k, 0) +
                            H_extent(i, 1) * filter.extent.var_width * H_extent(k, 1);
      out.R(i, k) = m.R(a, b) + (has_model_noise ? prediction.R_model(a, b) : 0) + extent;
      out.R(k, i) = m.R(b, a) + (has_model_noise ? prediction.R_model(b, a) : 0) + extent;
    }
  }
  atSeenRange(prediction, axis, model.extentAxes(), H_extent);
  for (Eigen::Index i = 0; i < n; ++i)
    if (!(model.extentAxes() >> axis[static_cast<std::size_t>(i)] & 1)) H_extent.row(i).setZero();
  out.R.diagonal().array() += 1e-9;  // keeps S invertible for any R (method.md 4)
  out.S = out.covarianceOf(filter.P);
  return out;
}

AxisVector Innovation::residualOf(const ModeFilter& mode, const ClassFilter& filter) const {
  Vector4 d = mode.x - filter.x;
  if (filter.oriented) d[3] = wrapAngle(d[3]);
  return y - H * d;
}

AxisMatrix Innovation::covarianceOf(const Matrix4& P) const {
  AxisMatrix S;
  withAxes(R.rows(), [&](auto axes) {
    const auto fixed = fixedRows<axes, 4>(H);
    fixedSquare<axes>(S) = fixed * P * fixed.transpose() + fixedRows<axes, axes>(R);
  });
  return S;
}

}  // namespace perception
