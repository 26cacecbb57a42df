#include "libperception/measurement/objects/MotionModel.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Angle.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {
namespace {

/// Below this standard deviation [rad] of the heading the tangent is used (method.md 3.2): the mean
/// step is .4 % shorter.
constexpr double kTangentHeadingSigma = radians(5);

/// method.md 3.1: F = [I dtI; 0 I], Q of white acceleration; position_psd adds slip. Returns F.
Matrix4 predictConstantVelocity(const ObjectClass& c, double psd, double damping, double dt,
                                Vector4& x, Matrix4& P) {
  const SpeedNoise n(damping, dt);
  Matrix4 F = Matrix4::Identity();
  F(0, 2) = F(1, 3) = n.effective_dt;
  F(2, 2) = F(3, 3) = n.decay;
  Matrix4 Q = Matrix4::Zero();
  for (int i = 0; i < 2; ++i) {
    Q(i, i) = psd * n.pp + c.position_psd * dt;
    Q(i, i + 2) = Q(i + 2, i) = psd * n.pv;
    Q(i + 2, i + 2) = psd * n.vv;
  }
  x = F * x;
  P = F * P * F.transpose() + Q;
  return F;
}

/// method.md 3.2: speed v along theta, both random walks; F of method.md (6), Q of method.md (7),
/// to first order, for any dt and composing consistently. Returns F.
Matrix4 predictWheeled(const ObjectClass& object_class, double psd, double damping, double dt,
                       Vector4& x, Matrix4& P) {
  const SpeedNoise noise(damping, dt);
  const double c = std::cos(x[3]), s = std::sin(x[3]), v = x[2];
  Matrix4 F = Matrix4::Identity();
  F(0, 2) = noise.effective_dt * c;
  F(0, 3) = -noise.effective_dt * v * s;
  F(1, 2) = noise.effective_dt * s;
  F(1, 3) = noise.effective_dt * v * c;
  F(2, 2) = noise.decay;
  const Vector2 u(c, s), n(-v * s, v * c);
  const double qw = object_class.yawRatePsd(v);
  Matrix4 Q = Matrix4::Zero();
  Q.topLeftCorner<2, 2>() =
      psd * noise.pp * u * u.transpose() + dt * dt * dt / 3 * qw * n * n.transpose();
  Q.topLeftCorner<2, 2>().diagonal().array() += object_class.position_psd * dt;
  Q.block<2, 1>(0, 2) = psd * noise.pv * u;
  Q.block<2, 1>(0, 3) = dt * dt / 2 * qw * n;
  Q.block<1, 2>(2, 0) = Q.block<2, 1>(0, 2).transpose();
  Q.block<1, 2>(3, 0) = Q.block<2, 1>(0, 3).transpose();
  Q(2, 2) = psd * noise.vv;
  Q(3, 3) = qw * dt;
  x[0] += noise.effective_dt * v * c;
  x[1] += noise.effective_dt * v * s;
  x[2] *= noise.decay;
  P = F * P * F.transpose() + Q;
  return F;
}

/// The same with exact moments of an uncertain heading in place of the tangent, method.md (8): with
/// (v, theta) jointly Gaussian, E[v e^(i theta)] = e^(i theta - s^2/2) (v + i cov(v, theta)) and
/// E[v^2 e^(2i theta)] = e^(2i theta - 2 s^2) ((v + 2i cov)^2 + var v), s^2 the heading's variance.
/// By Stein's lemma [stein1981] the slope of the best linear approximation is the mean of the
/// Jacobian.
Matrix4 predictUncertainHeading(const ObjectClass& object_class, double psd, double damping,
                                double dt, Vector4& x, Matrix4& P) {
  const SpeedNoise noise(damping, dt);
  const double v = x[2], spread = P(3, 3), cov = P(2, 3);
  const double c = std::cos(x[3]), s = std::sin(x[3]), shrink = std::exp(-0.5 * spread);
  const Vector2 u(shrink * c, shrink * s);  // E[e^(i theta)]
  const Vector2 mean(v * u.x() - cov * u.y(), v * u.y() + cov * u.x());
  const Vector2 n(-mean.y(), mean.x());  // d(mean)/d(theta)
  const double shrink4 = shrink * shrink * shrink * shrink;
  const Vector2 twice(shrink4 * (c * c - s * s), 2 * shrink4 * c * s);  // E[e^(2i theta)]
  const double whole = v * v + P(2, 2);
  const double re = whole - 4 * cov * cov, im = 4 * v * cov;  // (v + 2i cov)^2 + var v
  const Vector2 square(twice.x() * re - twice.y() * im, twice.x() * im + twice.y() * re);
  Matrix2 second;  // E[V V']
  second << 0.5 * (whole + square.x()), 0.5 * square.y(), 0.5 * square.y(),
      0.5 * (whole - square.x());
  Matrix2 slope;  // by v and theta
  slope << u, n;
  const Matrix2 unexplained =
      second - mean * mean.transpose() - slope * P.bottomRightCorner<2, 2>() * slope.transpose();

  Matrix4 F = Matrix4::Identity();
  F.block<2, 2>(0, 2) = noise.effective_dt * slope;
  F(2, 2) = noise.decay;
  const double qw = object_class.yawRatePsd(v);
  // E[u u'] of the unit vector along the motion, E[n n'] of v times that across it.
  Matrix2 along;
  along << 0.5 * (1 + twice.x()), 0.5 * twice.y(), 0.5 * twice.y(), 0.5 * (1 - twice.x());
  const Matrix2 across = whole * Matrix2::Identity() - second;
  // F P F' by blocks: F adds a function of (v, theta) to the position.
  const Matrix2 B = P.bottomRightCorner<2, 2>(), way = noise.effective_dt * slope;
  const Matrix2 moved = P.topRightCorner<2, 2>() + way * B;
  const Matrix2 back = way * P.bottomLeftCorner<2, 2>();
  P.topLeftCorner<2, 2>() += back + moved * way.transpose() + psd * noise.pp * along +
                             dt * dt * dt / 3 * qw * across +
                             noise.effective_dt * noise.effective_dt * unexplained;
  P(0, 0) += object_class.position_psd * dt;
  P(1, 1) += object_class.position_psd * dt;
  P.block<2, 1>(0, 2) = noise.decay * moved.col(0) + psd * noise.pv * u;
  P.block<2, 1>(0, 3) = moved.col(1) + dt * dt / 2 * qw * n;
  P.bottomLeftCorner<2, 2>() = P.topRightCorner<2, 2>().transpose().eval();
  P(2, 2) = noise.decay * noise.decay * B(0, 0) + psd * noise.vv;
  P(2, 3) = P(3, 2) = noise.decay * B(0, 1);
  P(3, 3) += qw * dt;
  x.head<2>() += noise.effective_dt * mean;
  x[2] *= noise.decay;
  return F;
}

bool needsSubSteps(const GaussianStep& s) {
  return s.oriented && (s.dt > 0.25 || (*s.P)(3, 3) > radians(30) * radians(30)) && s.dt > 0.1;
}

bool hasUncertainHeading(const GaussianStep& s) {
  return (*s.P)(3, 3) > kTangentHeadingSigma * kTangentHeadingSigma;
}

void stepConstantVelocity(const GaussianStep& s, Matrix4* transition) {
  const Matrix4 F = predictConstantVelocity(*s.object_class, s.psd, s.damping, s.dt, *s.x, *s.P);
  symmetrize(*s.P);
  if (transition) *transition = F;
}

Kinematics constantVelocityKinematics(const Vector4& x, bool) {
  Kinematics k;
  k.q.head<4>() = x;
  k.J.topRows<4>().setIdentity();
  return k;
}

BatchKernel constantVelocityKernel(const GaussianStep&) { return BatchKernel::kConstantVelocity; }

/// Wheeled step, in sub-steps where it is long or the heading is uncertain (method.md 3.2).
void stepWheeled(const GaussianStep& s, Matrix4* transition) {
  if (!s.oriented) return stepConstantVelocity(s, transition);
  Matrix4 whole = Matrix4::Identity();
  const int steps =
      needsSubSteps(s) ? static_cast<int>(std::clamp(std::ceil(s.dt / 0.1 - 1e-9), 1.0, 1e4)) : 1;
  for (int i = 0; i < steps; ++i) {
    const auto predict = hasUncertainHeading(s) ? predictUncertainHeading : predictWheeled;
    const Matrix4 F = predict(*s.object_class, s.psd, s.damping, s.dt / steps, *s.x, *s.P);
    if (transition) whole = F * whole;
  }
  symmetrize(*s.P);
  if (transition) *transition = whole;
}

Kinematics wheeledKinematics(const Vector4& x, bool oriented) {
  if (!oriented) return constantVelocityKinematics(x, oriented);
  Kinematics k;
  const double c = std::cos(x[3]), s = std::sin(x[3]), v = x[2];
  k.q << x[0], x[1], v * c, v * s, x[3];
  k.J(0, 0) = k.J(1, 1) = 1;
  k.J(2, 2) = c;
  k.J(2, 3) = -v * s;
  k.J(3, 2) = s;
  k.J(3, 3) = v * c;
  k.J(4, 3) = 1;
  k.has_yaw = true;
  return k;
}

BatchKernel wheeledKernel(const GaussianStep& s) {
  if (!s.oriented) return BatchKernel::kConstantVelocity;
  if (needsSubSteps(s)) return BatchKernel::kNone;
  return hasUncertainHeading(s) ? BatchKernel::kMoments : BatchKernel::kWheeled;
}

void stepStatic(const GaussianStep& s, Matrix4* transition) {
  s.P->topLeftCorner<2, 2>().diagonal().array() += s.object_class->position_psd * s.dt;
  if (transition) transition->setIdentity();
}

Kinematics staticKinematics(const Vector4& x, bool) {
  Kinematics k;
  k.q.head<2>() = x.head<2>();
  k.J(0, 0) = k.J(1, 1) = 1;
  return k;
}

}  // namespace

SpeedNoise::SpeedNoise(double a, double dt) {
  const double s = a * dt;
  if (s < 1e-3) {  // to first order in s: the closed forms cancel
    decay = 1 - s, effective_dt = dt * (1 - s / 2);
    pp = dt * dt * dt / 3 * (1 - 0.75 * s), pv = dt * dt / 2 * (1 - s), vv = dt * (1 - s);
    return;
  }
  decay = std::exp(-s), effective_dt = (1 - decay) / a;
  vv = (1 - decay * decay) / (2 * a);
  pv = effective_dt * effective_dt / 2;
  pp = (dt - effective_dt - a * effective_dt * effective_dt / 2) / (a * a);
}

std::deque<MotionModel>& motionModels() {
  static std::deque<MotionModel> models = {
      {"constant-velocity", true, false, stepConstantVelocity, constantVelocityKinematics,
       constantVelocityKernel},
      {"wheeled", true, true, stepWheeled, wheeledKinematics, wheeledKernel},
      {"static", false, false, stepStatic, staticKinematics, nullptr},
  };
  return models;
}

const MotionModel* findMotionModel(const std::string& name) {
  const auto& models = motionModels();
  const auto found = std::find_if(models.begin(), models.end(),
                                  [&](const MotionModel& m) { return m.name == name; });
  return found == models.end() ? nullptr : &*found;
}

}  // namespace perception
