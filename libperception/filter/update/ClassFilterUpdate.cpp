#include "libperception/filter/update/ClassFilterUpdate.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/state/FixedAxes.h"

namespace perception {
namespace {

constexpr double kLogLeastMode = -14;  // log probability, about 1e-6

/// Updates the extent, a static part of the state whose correlation with the rest is neglected, by
/// the edges seen. A floor of its variance accounts for systematic errors (rounded corners,
/// mirrors).
void updateExtentBy(const Innovation& innovation, Extent& e) {
  constexpr double kFloor = 0.1 * 0.1;  // [m^2]
  if (innovation.H_extent.isZero(0)) return;
  const Vector2 variance(e.var_length, e.var_width);
  Vector2 change = Vector2::Zero();
  Matrix2 gain = Matrix2::Zero();
  withAxes(innovation.y.size(), [&](auto n) {
    const Eigen::Matrix<double, n, 2> HV =
        fixedRows<n, 2>(innovation.H_extent) * variance.asDiagonal();
    const FixedFactors<n> S(fixedRows<n, n>(innovation.S));
    if (!S.positive()) return;
    change = HV.transpose() * S.template solve<1>(fixedRows<n, 1>(innovation.y));
    gain = HV.transpose() * S.template solve<2>(HV);
  });
  e.length = std::max(0.1, e.length + change.x());
  e.width = std::max(0.1, e.width + change.y());
  e.var_length = std::max(std::min(kFloor, e.var_length), e.var_length - gain(0, 0));
  e.var_width = std::max(std::min(kFloor, e.var_width), e.var_width - gain(1, 1));
}

/// josephUpdate() of one Gaussian by those axes that were seen.
double gaussianUpdate(const AxisVector& y, const AxisMatrix& S, const Innovation& innovation,
                      Vector4& x, Matrix4& P) {
  double log_density = kMinusInfinity;
  withAxes(y.size(), [&](auto n) {
    log_density = josephUpdate<n, 4>(fixedRows<n, 1>(y), fixedRows<n, 4>(innovation.H),
                                     fixedRows<n, n>(innovation.R), fixedRows<n, n>(S), x, P);
  });
  return log_density;
}

}  // namespace

void updateClassFilter(const Innovation& innovation, ClassFilter& f) {
  if (f.modes.empty()) {
    gaussianUpdate(innovation.y, innovation.S, innovation, f.x, f.P);
    if (f.oriented) f.x[3] = wrapAngle(f.x[3]);
  } else {
    std::vector<double> log_mode;
    for (auto& mode : f.modes) {
      const AxisVector y = innovation.residualOf(mode, f);
      const AxisMatrix S = innovation.covarianceOf(mode.P);
      log_mode.push_back(mode.log_probability + gaussianUpdate(y, S, innovation, mode.x, mode.P));
      if (f.oriented) mode.x[3] = wrapAngle(mode.x[3]);
    }
    weighModes(std::move(log_mode), f);
  }
  updateExtentBy(innovation, f.extent);
}

void weighModes(std::vector<double> log_mode, ClassFilter& f) {
  logNormalize(log_mode);
  for (std::size_t i = 0; i < log_mode.size(); ++i) {
    // A floor of the mode probability lets a mode recover within a few scans.
    f.modes[i].log_probability = std::max(log_mode[i], kLogLeastMode);
  }
  combineModes(f);
}

void positionUpdate(const Measurement& m, const Matrix2& noise, ClassFilter& f) {
  Matrix2 R = m.R + noise;
  R.diagonal().array() += 1e-9;  // as innovationOf()
  const Matrix2 S = f.P.topLeftCorner<2, 2>() + R;
  const FixedFactors<2> factors(S);
  if (!factors.positive()) return;
  using Gain = Eigen::Matrix<double, 4, 2>;
  const Gain K = factors.solve<4>(Eigen::Matrix<double, 2, 4>(f.P.topRows<2>())).transpose();
  const Vector2 y = Vector2(m.z) - f.x.head<2>();
  // Joseph form with H = (I 0): A = I - K H.
  Matrix2 top = Matrix2::Identity() - K.topRows<2>();
  const Matrix2 bottom = -K.bottomRows<2>();
  Matrix4 AP;
  AP.topRows<2>() = top * f.P.topRows<2>();
  AP.bottomRows<2>() = bottom * f.P.topRows<2>() + f.P.bottomRows<2>();
  Matrix4 P;
  P.leftCols<2>() = AP.leftCols<2>() * top.transpose();
  P.rightCols<2>() = AP.leftCols<2>() * bottom.transpose() + AP.rightCols<2>();
  const Gain KR = K * R;
  P += KR * K.transpose();
  f.x += K * y;
  if (f.oriented) f.x[3] = wrapAngle(f.x[3]);
  symmetrize(P);
  f.P = P;
}

}  // namespace perception
