#include "libperception/filter/state/ClassFilterMotion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/KalmanUpdate.h"

namespace perception {
namespace {

/// x - reference, the heading wrapped.
Vector4 modeDifference(const Vector4& x, const Vector4& reference, bool oriented) {
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
    mean += weights[i] * modeDifference(modes[i].x, reference, oriented);
  Moments out{reference + mean, Matrix4::Zero()};
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Vector4 d = modeDifference(modes[i].x, out.x, oriented);
    out.P += weights[i] * (modes[i].P + d * d.transpose());
  }
  if (oriented) out.x[3] = wrapAngle(out.x[3]);
  return out;
}

/// Mixing step of the interacting multiple model filter (Blom and Bar-Shalom 1988): each mode after
/// dt starts from the mixture of its possible predecessors.
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

bool movesSurely(const ClassFilter& f) { return f.x[2] * f.x[2] > 4 * f.P(2, 2); }

void correctWay(const Vector2& predicted, ClassFilter& f) {
  const Vector2 along(std::cos(f.x[3]), std::sin(f.x[3]));
  f.heading.traveled += along.dot(f.x.head<2>() - predicted);
}

void startModes(const ObjectClass& c, ClassFilter& f) {
  f.modes.clear();
  if (!c.motion->moves) return;
  const double total = std::accumulate(c.mode_sojourn.begin(), c.mode_sojourn.end(), 0.0);
  for (const double sojourn : c.mode_sojourn)
    f.modes.push_back({std::log(sojourn / total), f.x, f.P});
}

void startTwoSpeeds(double share, double sigma, ClassFilter& f) {
  f.modes = {{std::log1p(-share), f.x, f.P}, {std::log(share), f.x, f.P}};
  Matrix4& P = f.modes.back().P;
  P(2, 2) = P(3, 3) = sigma * sigma;
  combineModes(f);
}

void settleSpeeds(const ObjectClass& c, ClassFilter& f) {
  constexpr double kBeyondDoubt = 0.9;  // (assumed)
  if (c.modes() > 0) return;
  for (const ModeFilter& m : f.modes) {
    if (m.log_probability < std::log(kBeyondDoubt)) continue;
    f.x = m.x, f.P = m.P;
    f.modes.clear();
    return;
  }
}

void combineModes(ClassFilter& f) {
  if (f.modes.empty()) return;
  std::vector<double> weights;
  for (const auto& m : f.modes) weights.push_back(std::exp(m.log_probability));
  const Moments m = momentsOf(f.modes, weights, f.oriented);
  f.x = m.x;
  f.P = m.P;
}

void listSteps(const ObjectClass& c, double dt, ClassFilter& f, std::vector<GaussianStep>& out) {
  if (dt <= 0) return;
  const bool oriented = c.motion->has_heading && f.oriented;
  if (oriented && movesSurely(f)) f.heading.traveled += f.x[2] * dt;
  if (f.modes.empty()) {
    out.push_back({&f.x, &f.P, &c, c.accel_psd, 0, dt, oriented});
    return;
  }
  const bool interacting = c.modes() > 0;
  if (interacting) interact(c, dt, f);
  for (std::size_t i = 0; i < f.modes.size(); ++i) {
    const double psd = interacting ? c.mode_accel_psd[i] : c.accel_psd;
    const double damping = interacting ? c.mode_damping[i] : 0;
    out.push_back({&f.modes[i].x, &f.modes[i].P, &c, psd, damping, dt, oriented});
  }
}

void predictClassFilter(const ObjectClass& object_class, double dt, ClassFilter& f) {
  std::vector<GaussianStep> steps;
  listSteps(object_class, dt, f, steps);
  for (const auto& step : steps) predictGaussian(step);
  combineModes(f);
}

namespace {

/// [x, y, vx, vy] -> [x, y, v, theta] by a Jacobian of the velocity that all modes share.
template <class Carry>
void orientAll(ClassFilter& f, const Matrix4& J, Carry carry) {
  const auto one = [&](Vector4& x, Matrix4& P) {
    carry(x);
    P = J * P * J.transpose();
    symmetrize(P);
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
    josephUpdate<4>(y, variance, Eigen::RowVector4d::UnitW(), x, P);
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
