#include "libperception/filter/Heading.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"

namespace perception {
namespace {

// SPEC 7: the log-odds forget slowly and stay within bounds, 97 % of vehicles drive forward.
constexpr double kMemory = 0.98, kLogOddsLimit = 6, kForward = 0.97, kReverseAt = -0.5;
constexpr double kLeastFlip = 1e-3;  // no detector is surer of front and back than this
/// Share of detected axes that are not within their sigma of the object's but anywhere: 1 % of
/// Geiger's on KITTI lie beyond 22.5 deg (VISION_NOTES 2).
constexpr double kStray = 0.01;

double flipProbability(const HeadingSeen& seen) {
  return std::clamp(seen.flip_probability, kLeastFlip, 0.5);
}

/// log P(v | theta is the heading) / P(v | theta is its opposite).
double logForward(double v, double v_variance) {
  const double positive = 0.5 * std::erfc(-v / std::sqrt(2 * std::max(v_variance, 1e-12)));
  return std::log((kForward * positive + (1 - kForward) * (1 - positive)) /
                  ((1 - kForward) * positive + kForward * (1 - positive)));
}

}  // namespace

HeadingResidual headingResidual(const HeadingSeen& seen, double theta, HeadingMode mode) {
  const double direct = wrapAngle(seen.yaw - theta);
  const double opposite = direct > 0 ? direct - kPi : direct + kPi;
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
  const double variance = r.variance + theta_variance;
  const double nearer = 0.5 * (std::log(kTwoPi / variance) - r.y * r.y / variance);
  if (mode == HeadingMode::kWide) return nearer;
  const double p = flipProbability(seen), other = kPi - std::abs(r.y);
  const double ratio = std::exp(0.5 * (r.y * r.y - other * other) / variance);  // at most 1
  return nearer + std::log(r.same ? (1 - p) + p * ratio : p + (1 - p) * ratio);
}

HeadingBit firstHeadingBit(const HeadingSeen& seen) {
  HeadingBit bit = nextHeadingBit({}, true, seen);
  bit.axis_log_odds = std::min(std::log((1 - kStray) / kStray), kLogOddsLimit);
  return bit;
}

HeadingBit nextHeadingBit(const HeadingBit& bit, bool same, const HeadingSeen& seen) {
  const double p = flipProbability(seen), evidence = std::log((1 - p) / p);
  HeadingBit next = bit;
  next.log_odds = std::clamp(kMemory * bit.log_odds + (same ? evidence : -evidence), -kLogOddsLimit,
                             kLogOddsLimit);
  ++(same ? next.same : next.opposite);
  return next;
}

double nextAxisLogOdds(const HeadingBit& bit, const HeadingSeen& seen, double theta,
                       double theta_variance) {
  const HeadingResidual r = headingResidual(seen, theta, HeadingMode::kSplit);
  const double variance = r.variance + theta_variance;
  const double near = std::exp(-0.5 * r.y * r.y / variance) / std::sqrt(kTwoPi * variance);
  const double evidence =
      std::log((1 - kStray) * kPi * near + kStray);  // over the axes' uniform density of 1 / pi
  return std::clamp(kMemory * bit.axis_log_odds + evidence, -kLogOddsLimit, kLogOddsLimit);
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
