#include "libperception/filter/Heading.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/core/LogMath.h"

namespace perception {
namespace {

// SPEC 7: the log-odds forget slowly and stay within bounds, 97 % of vehicles drive forward.
constexpr double kMemory = 0.98, kLogOddsLimit = 6, kForward = 0.97, kReverseAt = -0.5;
constexpr double kLeastFlip = 1e-3;  // no detector is surer of front and back than this

double flipProbability(const HeadingSeen& seen) {
  return std::clamp(seen.flip_probability, kLeastFlip, 0.5);
}

double logNormal(double y, double variance) {
  return -0.5 * (y * y / variance + std::log(kTwoPi * variance));
}

/// log P(v | theta is the heading) / P(v | theta is its opposite).
double logForward(double v, double v_variance) {
  const double positive = 0.5 * std::erfc(-v / std::sqrt(2 * std::max(v_variance, 1e-12)));
  return std::log((kForward * positive + (1 - kForward) * (1 - positive)) /
                  ((1 - kForward) * positive + kForward * (1 - positive)));
}

}  // namespace

HeadingResidual headingResidual(const HeadingSeen& seen, double theta, HeadingMode mode) {
  const double direct = wrapAngle(seen.yaw - theta), opposite = wrapAngle(direct + kPi);
  const double variance = seen.sigma * seen.sigma;
  const bool same = std::abs(direct) <= std::abs(opposite);
  if (mode == HeadingMode::kWide)
    return {direct, variance + flipProbability(seen) * kPi * kPi, same};
  return {same ? direct : opposite, variance, same};
}

double logHeadingRatio(const HeadingSeen& seen, double theta, double theta_variance,
                       HeadingMode mode) {
  if (mode == HeadingMode::kIgnored) return 0;
  const HeadingResidual r = headingResidual(seen, theta, mode);
  const double variance = r.variance + theta_variance, uniform = std::log(kTwoPi);
  if (mode == HeadingMode::kWide) return uniform + logNormal(r.y, variance);
  const double p = flipProbability(seen);
  const double near = logNormal(r.y, variance), far = logNormal(kPi - std::abs(r.y), variance);
  return uniform + (r.same ? logAddExp(std::log1p(-p) + near, std::log(p) + far)
                           : logAddExp(std::log(p) + near, std::log1p(-p) + far));
}

HeadingBit firstHeadingBit(const HeadingSeen& seen) { return nextHeadingBit({}, true, seen); }

HeadingBit nextHeadingBit(const HeadingBit& bit, bool same, const HeadingSeen& seen) {
  const double p = flipProbability(seen), evidence = std::log((1 - p) / p);
  HeadingBit next = bit;
  next.log_odds = std::clamp(kMemory * bit.log_odds + (same ? evidence : -evidence), -kLogOddsLimit,
                             kLogOddsLimit);
  ++(same ? next.same : next.opposite);
  return next;
}

bool asksForReversal(const HeadingBit& bit, double v, double v_variance, HeadingMode mode) {
  switch (mode) {
    case HeadingMode::kSplit:
      return bit.log_odds + logForward(v, v_variance) < kReverseAt;
    case HeadingMode::kCounting:
      return bit.opposite > bit.same;
    case HeadingMode::kWide:
    case HeadingMode::kIgnored:
      break;
  }
  return false;
}

}  // namespace perception
