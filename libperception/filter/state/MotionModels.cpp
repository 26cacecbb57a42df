#include "libperception/filter/state/MotionModels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/core/Angle.h"

namespace perception {
namespace {

/// A heading known so well moves along its tangent: the mean step is .4 % shorter.
constexpr double kSureHeading = radians(5);

void symmetrise(Matrix4& P) { P = (0.5 * (P + P.transpose())).eval(); }

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

/// method.md 3.2: speed v along theta, both random walks; Q to first order, valid for any dt and
/// composing consistently. Returns F.
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
  const double qw = object_class.yaw_rate_psd;
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

/// The same with the moments of an uncertain heading in place of the tangent: with (v, theta)
/// jointly Gaussian, E[v e^(i theta)] = e^(i theta - s^2/2) (v + i cov(v, theta)) and
/// E[v^2 e^(2i theta)] = e^(2i theta - 2 s^2) ((v + 2i cov)^2 + var v), s^2 the heading's variance.
/// By Stein's lemma the best line through the curve has the mean of the Jacobian as its slope.
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
  const double qw = object_class.yaw_rate_psd;
  // E[u u'] of the unit vector along the motion, E[n n'] of v times that across it.
  Matrix2 along;
  along << 0.5 * (1 + twice.x()), 0.5 * twice.y(), 0.5 * twice.y(), 0.5 * (1 - twice.x());
  const Matrix2 across = whole * Matrix2::Identity() - second;
  // F P F' by blocks: F changes the place by the second half of the state alone.
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

/// x - reference, the heading wrapped.
Vector4 difference(const Vector4& x, const Vector4& reference, bool oriented) {
  Vector4 d = x - reference;
  if (oriented) d[3] = wrapAngle(d[3]);
  return d;
}

/// Mean and spread of a mixture of Gaussians about a common reference.
struct Moments {
  Vector4 x;
  Matrix4 P;
};
Moments momentsOf(const std::vector<ModeFilter>& modes, const std::vector<double>& weights,
                  bool oriented) {
  const auto heaviest =
      static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  const Vector4& reference = modes[heaviest].x;
  Vector4 mean = Vector4::Zero();
  for (std::size_t i = 0; i < modes.size(); ++i)
    mean += weights[i] * difference(modes[i].x, reference, oriented);
  Moments out{reference + mean, Matrix4::Zero()};
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Vector4 d = difference(modes[i].x, out.x, oriented);
    out.P += weights[i] * (modes[i].P + d * d.transpose());
  }
  if (oriented) out.x[3] = wrapAngle(out.x[3]);
  return out;
}

/// The interaction of interacting multiple models (Blom and Bar-Shalom 1988): modes as they will
/// be after dt, each starting from the mixture that could have led there.
void interact(const ObjectClass& c, double dt, ClassFilter& f) {
  const std::size_t n = f.modes.size();
  std::vector<ModeFilter> mixed(n);
  std::vector<double> weights(n);
  for (std::size_t to = 0; to < n; ++to) {
    double total = 0;
    for (std::size_t from = 0; from < n; ++from) {
      const double stays = std::exp(-dt / c.mode_sojourn[from]);
      const double moves = from == to ? stays : (1 - stays) / static_cast<double>(n - 1);
      total += weights[from] = moves * std::exp(f.modes[from].log_probability);
    }
    for (double& w : weights) w /= total;
    const Moments m = momentsOf(f.modes, weights, f.oriented);
    mixed[to] = {std::log(total), m.x, m.P};
  }
  f.modes = std::move(mixed);
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

bool needsSubSteps(const GaussianStep& s) {
  return s.oriented && (s.dt > 0.25 || (*s.P)(3, 3) > radians(30) * radians(30)) && s.dt > 0.1;
}

bool hasUncertainHeading(const GaussianStep& s) {
  return s.oriented && (*s.P)(3, 3) > kSureHeading * kSureHeading;
}

void predictGaussian(const GaussianStep& s, Matrix4* transition) {
  Matrix4 whole = Matrix4::Identity();
  if (!s.oriented) {
    whole = predictConstantVelocity(*s.object_class, s.psd, s.damping, s.dt, *s.x, *s.P);
  } else {
    const int steps =
        needsSubSteps(s) ? std::max(1, static_cast<int>(std::ceil(s.dt / 0.1 - 1e-9))) : 1;
    for (int i = 0; i < steps; ++i) {
      const auto predict = hasUncertainHeading(s) ? predictUncertainHeading : predictWheeled;
      const Matrix4 F = predict(*s.object_class, s.psd, s.damping, s.dt / steps, *s.x, *s.P);
      if (transition) whole = F * whole;
    }
  }
  symmetrise(*s.P);
  if (transition) *transition = whole;
}

void startModes(const ObjectClass& c, ClassFilter& f) {
  f.modes.clear();
  if (c.motion == Motion::kStatic) return;
  const double total = std::accumulate(c.mode_sojourn.begin(), c.mode_sojourn.end(), 0.0);
  for (const double sojourn : c.mode_sojourn)
    f.modes.push_back({std::log(sojourn / total), f.x, f.P});
}

void combineModes(ClassFilter& f) {
  if (f.modes.empty()) return;
  std::vector<double> weights;
  for (const auto& m : f.modes) weights.push_back(std::exp(m.log_probability));
  const Moments m = momentsOf(f.modes, weights, f.oriented);
  f.x = m.x;
  f.P = m.P;
}

void beginPrediction(const ObjectClass& object_class, double dt, ClassFilter& f,
                     std::vector<GaussianStep>& out) {
  if (dt <= 0) return;
  const bool oriented = object_class.motion == Motion::kWheeled && f.oriented;
  if (object_class.motion == Motion::kStatic) {
    f.P.topLeftCorner<2, 2>().diagonal().array() += object_class.position_psd * dt;
  } else if (f.modes.empty()) {
    out.push_back({&f.x, &f.P, &object_class, object_class.accel_psd, 0, dt, oriented});
  } else {
    interact(object_class, dt, f);
    for (std::size_t i = 0; i < f.modes.size(); ++i) {
      out.push_back({&f.modes[i].x, &f.modes[i].P, &object_class, object_class.mode_accel_psd[i],
                     object_class.mode_damping[i], dt, oriented});
    }
  }
}

void predictClassFilter(const ObjectClass& object_class, double dt, ClassFilter& f) {
  std::vector<GaussianStep> steps;
  beginPrediction(object_class, dt, f, steps);
  for (const auto& step : steps) predictGaussian(step);
  combineModes(f);
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

namespace {

/// [x, y, vx, vy] -> [x, y, v, theta] by a Jacobian of the velocity that all modes share.
template <class Carry>
void orientAll(ClassFilter& f, const Matrix4& J, Carry carry) {
  const auto one = [&](Vector4& x, Matrix4& P) {
    carry(x);
    P = J * P * J.transpose();
    symmetrise(P);
  };
  for (auto& m : f.modes) one(m.x, m.P);
  one(f.x, f.P);
  f.oriented = true;
}

}  // namespace

void orientByVelocity(ClassFilter& f) {
  const Vector2 mean = f.x.tail<2>();
  const double v = std::max(mean.norm(), 1e-6);
  const Vector2 along = mean / v, across(-along.y(), along.x());
  const double theta = std::atan2(mean.y(), mean.x());
  Matrix4 J = Matrix4::Identity();
  J.bottomRightCorner<2, 2>() << along.transpose(), across.transpose() / v;
  // A mode's own velocity is taken to first order about the mean.
  orientAll(f, J, [&](Vector4& x) {
    const Vector2 own = x.tail<2>();
    x.tail<2>() << along.dot(own), wrapAngle(theta + across.dot(own) / v);
  });
}

void orientByAxis(double yaw, double yaw_variance, ClassFilter& f) {
  const double forward = std::cos(yaw) * f.x[2] + std::sin(yaw) * f.x[3];
  orientAlong(forward < 0 ? wrapAngle(yaw + kPi) : yaw, yaw_variance, f);
}

void orientAlong(double yaw, double yaw_variance, ClassFilter& f) {
  const Vector2 along(std::cos(yaw), std::sin(yaw));
  Matrix4 J = Matrix4::Identity();
  J.bottomRightCorner<2, 2>() << along.transpose(), 0, 0;
  orientAll(f, J, [&](Vector4& x) {
    const double v = along.dot(x.tail<2>());
    x.tail<2>() << v, yaw;
  });
  for (auto& m : f.modes) m.P(3, 3) = yaw_variance;
  f.P(3, 3) = yaw_variance;
}

void reorient(double yaw, double yaw_variance, ClassFilter& f) {
  const auto one = [](Vector4& x, Matrix4& P) {
    const double v = x[2], c = std::cos(x[3]), s = std::sin(x[3]);
    Matrix4 J = Matrix4::Identity();
    J.bottomRightCorner<2, 2>() << c, -v * s, s, v * c;
    x.tail<2>() << v * c, v * s;
    P = (J * P * J.transpose()).eval();
  };
  for (auto& m : f.modes) one(m.x, m.P);
  one(f.x, f.P);
  orientAlong(yaw, yaw_variance, f);
}

void reverse(ClassFilter& f) {
  const auto one = [](Vector4& x, Matrix4& P) {
    x[2] = -x[2];
    x[3] = wrapAngle(x[3] + kPi);
    P.row(2) *= -1;
    P.col(2) *= -1;
  };
  for (auto& m : f.modes) one(m.x, m.P);
  one(f.x, f.P);
  f.heading = f.heading.reversed();
}

void updateYaw(double y, double variance, ClassFilter& f) {
  const auto one = [&](Vector4& x, Matrix4& P) {
    const Vector4 K = P.col(3) / (P(3, 3) + variance);
    x += K * y;
    P = (P - K * P.row(3)).eval();
    P = (0.5 * (P + P.transpose())).eval();
    x[3] = wrapAngle(x[3]);
  };
  if (f.modes.empty()) {
    one(f.x, f.P);
    return;
  }
  const double mean = f.x[3];
  const double target = y + mean;
  for (auto& m : f.modes) {
    y = wrapAngle(target - m.x[3]);
    one(m.x, m.P);
  }
  combineModes(f);
}

}  // namespace perception
