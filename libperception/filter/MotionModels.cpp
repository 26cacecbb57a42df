#include "libperception/filter/MotionModels.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"

namespace perception {
namespace {

void symmetrise(Matrix4& P) { P = (0.5 * (P + P.transpose())).eval(); }

/// SPEC 3.1: F = [I dtI; 0 I], Q of white acceleration; position_psd adds slip.
void predictConstantVelocity(const ObjectClass& c, double dt, ClassFilter& f) {
  Matrix4 F = Matrix4::Identity();
  F(0, 2) = F(1, 3) = dt;
  Matrix4 Q = Matrix4::Zero();
  const double q = c.accel_psd;
  for (int i = 0; i < 2; ++i) {
    Q(i, i) = q * dt * dt * dt / 3 + c.position_psd * dt;
    Q(i, i + 2) = Q(i + 2, i) = q * dt * dt / 2;
    Q(i + 2, i + 2) = q * dt;
  }
  f.x = F * f.x;
  f.P = F * f.P * F.transpose() + Q;
}

/// SPEC 3.2: speed v along theta, both random walks; Q to first order, valid for any dt and
/// composing consistently.
void predictWheeled(const ObjectClass& object_class, double dt, ClassFilter& f) {
  const double c = std::cos(f.x[3]), s = std::sin(f.x[3]), v = f.x[2];
  Matrix4 F = Matrix4::Identity();
  F(0, 2) = dt * c;
  F(0, 3) = -dt * v * s;
  F(1, 2) = dt * s;
  F(1, 3) = dt * v * c;
  const Vector2 u(c, s), n(-v * s, v * c);
  const double qv = object_class.accel_psd, qw = object_class.yaw_rate_psd;
  Matrix4 Q = Matrix4::Zero();
  Q.topLeftCorner<2, 2>() = dt * dt * dt / 3 * (qv * u * u.transpose() + qw * n * n.transpose());
  Q.topLeftCorner<2, 2>().diagonal().array() += object_class.position_psd * dt;
  Q.block<2, 1>(0, 2) = dt * dt / 2 * qv * u;
  Q.block<2, 1>(0, 3) = dt * dt / 2 * qw * n;
  Q.block<1, 2>(2, 0) = Q.block<2, 1>(0, 2).transpose();
  Q.block<1, 2>(3, 0) = Q.block<2, 1>(0, 3).transpose();
  Q(2, 2) = qv * dt;
  Q(3, 3) = qw * dt;
  f.x[0] += dt * v * c;
  f.x[1] += dt * v * s;
  f.P = F * f.P * F.transpose() + Q;
}

}  // namespace

void predictClassFilter(const ObjectClass& object_class, double dt, ClassFilter& f) {
  if (dt <= 0) return;
  if (object_class.motion == Motion::kStatic) {
    f.P.topLeftCorner<2, 2>().diagonal().array() += object_class.position_psd * dt;
    return;
  }
  if (object_class.motion == Motion::kConstantVelocity || !f.oriented) {
    predictConstantVelocity(object_class, dt, f);
  } else {
    const bool fine = dt > 0.25 || f.P(3, 3) > radians(30) * radians(30);
    const int steps = fine ? std::max(1, static_cast<int>(std::ceil(dt / 0.1 - 1e-9))) : 1;
    for (int i = 0; i < steps; ++i) predictWheeled(object_class, dt / steps, f);
  }
  symmetrise(f.P);
}

Kinematics kinematicsOf(const ObjectClass& object_class, const ClassFilter& f) {
  Kinematics k;
  k.q.head<2>() = f.x.head<2>();
  k.J(0, 0) = k.J(1, 1) = 1;
  if (object_class.motion == Motion::kStatic) return k;
  if (object_class.motion == Motion::kConstantVelocity || !f.oriented) {
    k.q.segment<2>(2) = f.x.tail<2>();
    k.J(2, 2) = k.J(3, 3) = 1;
    return k;
  }
  const double c = std::cos(f.x[3]), s = std::sin(f.x[3]), v = f.x[2];
  k.q << f.x[0], f.x[1], v * c, v * s, f.x[3];
  k.J(2, 2) = c;
  k.J(2, 3) = -v * s;
  k.J(3, 2) = s;
  k.J(3, 3) = v * c;
  k.J(4, 3) = 1;
  k.has_yaw = true;
  return k;
}

void orientByVelocity(ClassFilter& f) {
  const double vx = f.x[2], vy = f.x[3];
  const double v = std::max(std::hypot(vx, vy), 1e-6);
  Matrix4 J = Matrix4::Identity();
  J.bottomRightCorner<2, 2>() << vx / v, vy / v, -vy / (v * v), vx / (v * v);
  f.x.tail<2>() << v, std::atan2(vy, vx);
  f.P = J * f.P * J.transpose();
  symmetrise(f.P);
  f.oriented = true;
}

void orientByAxis(double yaw, double yaw_variance, ClassFilter& f) {
  double theta = yaw;
  double v = std::cos(theta) * f.x[2] + std::sin(theta) * f.x[3];
  if (v < 0) {
    theta = wrapAngle(theta + kPi);
    v = -v;
  }
  Matrix4 J = Matrix4::Identity();
  J.bottomRightCorner<2, 2>() << std::cos(theta), std::sin(theta), 0, 0;
  f.x.tail<2>() << v, theta;
  f.P = J * f.P * J.transpose();
  f.P(3, 3) = yaw_variance;
  symmetrise(f.P);
  f.oriented = true;
}

void reverse(ClassFilter& f) {
  f.x[2] = -f.x[2];
  f.x[3] = wrapAngle(f.x[3] + kPi);
  f.P.row(2) *= -1;
  f.P.col(2) *= -1;
}

}  // namespace perception
