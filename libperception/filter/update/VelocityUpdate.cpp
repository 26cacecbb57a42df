#include "libperception/filter/update/VelocityUpdate.h"

#include <cmath>
#include <utility>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/filter/update/ClassFilterUpdate.h"

namespace perception {
namespace {

/// A component of the velocity as a measurement of a state.
struct VelocityAxis {
  Eigen::RowVector4d h;
  double expected = 0;  ///< [m/s]

  VelocityAxis(const Vector2& direction, const Vector4& x, bool oriented) : h(0, 0, 0, 0) {
    if (oriented) {
      const Vector2 ahead(std::cos(x[3]), std::sin(x[3]));
      h[2] = direction.dot(ahead);
      h[3] = x[2] * direction.dot(Vector2(-ahead.y(), ahead.x()));
      expected = h[2] * x[2];
    } else {
      h[2] = direction.x(), h[3] = direction.y();
      expected = h * x;
    }
  }
};

double updateAxis(const Vector2& direction, const ScalarEstimate& speed, bool oriented, Vector4& x,
                  Matrix4& P) {
  const VelocityAxis axis(direction, x, oriented);
  const double log_density =
      josephUpdate<4>(speed.mean - axis.expected, speed.variance, axis.h, x, P);
  if (oriented) x[3] = wrapAngle(x[3]);
  return log_density;
}

double updateBoth(const RadialSpeed& seen, bool oriented, Vector4& x, Matrix4& P) {
  const double log_density = updateAxis(seen.direction, seen.along, oriented, x, P);
  if (!seen.across_sigma) return log_density;
  const Vector2 across(-seen.direction.y(), seen.direction.x());
  return log_density +
         updateAxis(across, {0, *seen.across_sigma * *seen.across_sigma}, oriented, x, P);
}

}  // namespace

void updateVelocity(const RadialSpeed& seen, ClassFilter& f) {
  if (f.modes.empty()) {
    updateBoth(seen, f.oriented, f.x, f.P);
    return;
  }
  std::vector<double> log_mode;
  for (ModeFilter& m : f.modes)
    log_mode.push_back(m.log_probability + updateBoth(seen, f.oriented, m.x, m.P));
  weighModes(std::move(log_mode), f);
}

double logRadialSpeed(const ObjectClass& c, const ClassFilter& f, const RadialSpeed& seen) {
  constexpr double kElse = 0.05;   // assumed probability that the motion is of something else
  constexpr double kSpeeds = 90;   // [m/s] assumed range of the speeds of something else
  constexpr double kLeaves = 0.3;  // [m/s] assumed deviation of what does not move, as leaves
  const auto density = [&](const Vector4& x, const Matrix4& P) {
    double variance = seen.along.variance, expected = 0;
    if (c.motion->moves) {
      VelocityAxis axis(seen.direction, x, f.oriented);
      if (f.oriented) axis.h[3] = 0;  // at the heading that it has
      variance += axis.h * P * axis.h.transpose(), expected = axis.expected;
    } else {
      variance += kLeaves * kLeaves;
    }
    const double y = seen.along.mean - expected;
    return std::exp(-0.5 * y * y / variance) / std::sqrt(kTwoPi * variance);
  };
  double p = f.modes.empty() ? density(f.x, f.P) : 0;
  for (const ModeFilter& m : f.modes) p += std::exp(m.log_probability) * density(m.x, m.P);
  return std::log((1 - kElse) * p + kElse / kSpeeds);
}

bool deniesHeading(const RadialSpeed& seen, const ClassFilter& f) {
  constexpr double kGate = 9;  // squared deviations (assumed)
  if (!f.oriented) return false;
  const VelocityAxis axis(seen.direction, f.x, true);
  const double y = seen.along.mean - axis.expected;
  return y * y > kGate * (axis.h[2] * axis.h[2] * f.P(2, 2) + seen.along.variance);
}

double logSpeed(const ObjectClass& c, const ClassFilter& f, const FilterParams& params) {
  if (!c.motion->moves || params.speed_slack <= 0) return 0;
  const double speed = f.oriented ? std::abs(f.x[2]) : f.x.tail<2>().norm();
  const double variance = f.oriented ? f.P(2, 2) : 0.5 * (f.P(2, 2) + f.P(3, 3));
  const double excess = speed - c.max_speed, slack = params.speed_slack * c.max_speed;
  return excess <= 0 ? 0 : -0.5 * excess * excess / (slack * slack + variance);
}

}  // namespace perception
