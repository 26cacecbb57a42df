#include "studies/paper/PaperFilters.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

void predictEuler(const PaperClass& c, double dt, Vector4& x, Matrix4& P) {
  Matrix4 F = Matrix4::Identity();
  const double qa = std::pow(c.accel_sigma * dt, 2);
  Vector4 noise(0, 0, qa, qa);
  if (c.wheeled) {
    const double cs = std::cos(x[3]), sn = std::sin(x[3]), v = x[2];
    F(0, 2) = dt * cs, F(0, 3) = -dt * v * sn;
    F(1, 2) = dt * sn, F(1, 3) = dt * v * cs;
    x[0] += dt * v * cs;
    x[1] += dt * v * sn;
    noise[3] = std::pow(c.rotation_sigma * dt, 2);
  } else {
    F(0, 2) = F(1, 3) = dt;
    x = F * x;
  }
  P = F * P * F.transpose();
  P.diagonal() += noise;
}

}  // namespace

FilterTrace runPaperFilter(const PaperClass& c, const std::vector<Vector2>& z, double dt,
                           const Matrix2& R) {
  FilterTrace trace;
  if (z.size() < 2) return trace;
  const Vector2 velocity = (z[1] - z[0]) / dt;
  Vector4 x;
  Matrix4 P = Matrix4::Zero();
  P.topLeftCorner<2, 2>() = R;
  if (c.wheeled) {
    x << z[0], velocity.norm(), std::atan2(velocity.y(), velocity.x());
    P(2, 2) = c.start_speed_variance, P(3, 3) = c.start_heading_variance;
  } else {
    x << z[0], velocity;
    P(2, 2) = P(3, 3) = c.start_speed_variance;
  }
  for (std::size_t k = 0; k < z.size(); ++k) {
    if (k > 0) predictEuler(c, dt, x, P);
    const Vector2 y = z[k] - x.head<2>();
    const Matrix2 S = P.topLeftCorner<2, 2>() + R;
    const Matrix2 inverse = S.inverse();
    const double nis = y.dot(inverse * y);
    trace.nis.push_back(nis);
    trace.log_density.push_back(-0.5 * nis - 0.5 * std::log(S.determinant()) - std::log(kTwoPi));
    const Eigen::Matrix<double, 4, 2> K = P.leftCols<2>() * inverse;
    x += K * y;
    P = (P - K * P.topRows<2>()).eval();
    P = (0.5 * (P + P.transpose())).eval();
  }
  return trace;
}

std::vector<Vector2> simulatePaperTrack(const PaperClass& c, double speed, int steps, double dt,
                                        const Matrix2& R, Rng& rng) {
  const Matrix2 L = R.llt().matrixL();
  const double heading = rng.uniform(-kPi, kPi);
  Vector4 x(0, 0, speed, heading);
  if (!c.wheeled) x.tail<2>() << speed * std::cos(heading), speed * std::sin(heading);
  std::vector<Vector2> z;
  for (int k = 0; k < steps; ++k) {
    const Vector2 noise(rng.normal(), rng.normal());
    z.push_back(x.head<2>() + L * noise);
    if (c.wheeled) {
      x[0] += dt * x[2] * std::cos(x[3]);
      x[1] += dt * x[2] * std::sin(x[3]);
      x[2] += dt * c.accel_sigma * rng.normal();
      x[3] += dt * c.rotation_sigma * rng.normal();
    } else {
      x.head<2>() += dt * x.tail<2>();
      x[2] += dt * c.accel_sigma * rng.normal();
      x[3] += dt * c.accel_sigma * rng.normal();
    }
  }
  return z;
}

double logChi2Density(double x, double dof) {
  const double half = 0.5 * dof;
  return (half - 1) * std::log(x) - 0.5 * x - half * std::log(2.0) - std::lgamma(half);
}

}  // namespace perception
