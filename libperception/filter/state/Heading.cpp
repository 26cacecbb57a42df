#include "libperception/filter/state/Heading.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// method.md 7: the log-odds forget slowly and stay within bounds, 97 % of vehicles drive forward.
constexpr double kMemory = 0.98, kLogOddsLimit = 6, kForward = 0.97, kReverseAt = -0.5;
/// The limit of 6 accounts for repeated reversals; with flip_persistence, which models these, it is
/// twice as large.
constexpr double kLimitWithRepeats = 12;
constexpr double kLeastFlip = 1e-3;  // lower bound of the flip probability

double flipProbability(const MeasuredHeading& seen) {
  return std::clamp(seen.flip_probability, kLeastFlip, 0.5);
}

/// [m] deviation of the way that a standing object seems to travel while other parts of it come
/// into view: its center is uniform within the length of a car of 4.4 m.
constexpr double kChanceTravel = 1.3;
/// [m] over which the share of those who still reverse falls by e, down to a tenth (assumed).
constexpr double kReverseFor = 10, kLeastShare = 0.1;

struct BitEvidence {
  double log_odds = 0;  // that theta is the heading and not its opposite
  double limit = kLogOddsLimit;
};

BitEvidence evidenceOf(bool same, int last, const MeasuredHeading& seen) {
  const double p = flipProbability(seen), after_flip = std::max(seen.flip_persistence, p);
  if (last == 0 || after_flip <= p) {
    const double evidence = std::log((1 - p) / p);
    return {same ? evidence : -evidence, after_flip > p ? kLimitWithRepeats : kLogOddsLimit};
  }
  // The chain's share of reversals stays p.
  const double after_right = p * (1 - after_flip) / (1 - p);
  const auto probability = [&](bool before_right, bool now_right) {
    const double reversed = before_right ? after_right : after_flip;
    return now_right ? 1 - reversed : reversed;
  };
  return {std::log(probability(last > 0, same) / probability(last < 0, !same)), kLimitWithRepeats};
}

/// log P(v | theta is the heading) / P(v | theta is its opposite), where the share `forward` of all
/// who move does so forward.
double logForward(double v, double v_variance, double forward = kForward) {
  const double positive = 0.5 * std::erfc(-v / std::sqrt(2 * std::max(v_variance, 1e-12)));
  return std::log((forward * positive + (1 - forward) * (1 - positive)) /
                  ((1 - forward) * positive + forward * (1 - positive)));
}

}  // namespace

HeadingResidual headingResidual(const MeasuredHeading& seen, double theta, HeadingMode mode) {
  const double direct = wrapAngle(seen.yaw - theta);
  const double opposite = direct > 0 ? direct - kPi : direct + kPi;
  const double variance = seen.sigma * seen.sigma;
  const bool same = std::abs(direct) <= std::abs(opposite);
  if (mode == HeadingMode::kWide)
    return {direct, variance + flipProbability(seen) * kPi * kPi, same};
  return {same ? direct : opposite, variance, same};
}

double logHeadingRatio(const MeasuredHeading& seen, double theta, double theta_variance,
                       HeadingMode mode) {
  const HeadingResidual r = headingResidual(seen, theta, mode);
  const double variance = r.variance + theta_variance;
  const double nearer = 0.5 * (std::log(kTwoPi / variance) - r.y * r.y / variance);
  if (mode == HeadingMode::kWide) return nearer;
  const double p = flipProbability(seen), other = kPi - std::abs(r.y);
  const double ratio = std::exp(0.5 * (r.y * r.y - other * other) / variance);  // at most 1
  return nearer + std::log(r.same ? (1 - p) + p * ratio : p + (1 - p) * ratio);
}

FrontBackAmbiguity firstFrontBack(const MeasuredHeading& seen) {
  FrontBackAmbiguity bit = nextFrontBack({}, true, seen);
  bit.axis_log_odds = std::min(std::log((1 - kStrayAxes) / kStrayAxes), kLogOddsLimit);
  return bit;
}

FrontBackAmbiguity nextFrontBack(const FrontBackAmbiguity& bit, bool same,
                                 const MeasuredHeading& seen) {
  const BitEvidence evidence = evidenceOf(same, bit.last, seen);
  FrontBackAmbiguity next = bit;
  next.log_odds =
      std::clamp(kMemory * bit.log_odds + evidence.log_odds, -evidence.limit, evidence.limit);
  ++(same ? next.same : next.opposite);
  next.last = same ? 1 : -1;
  return next;
}

void seeShape(double front_log_odds, FrontBackAmbiguity& bit) {
  constexpr int kMostViews =
      20;  // older views fade: other objects may have been mixed in (assumed)
  bit.views = std::min(bit.views + 1, kMostViews);
  bit.shape += (front_log_odds - bit.shape) / bit.views;
}

double nextAxisLogOdds(const FrontBackAmbiguity& bit, const MeasuredHeading& seen, double theta,
                       double theta_variance, double stray) {
  const HeadingResidual r = headingResidual(seen, theta, HeadingMode::kSplit);
  const double variance = r.variance + theta_variance;
  const double near = std::exp(-0.5 * r.y * r.y / variance) / std::sqrt(kTwoPi * variance);
  const double evidence =
      std::log((1 - stray) * kPi * near + stray);  // over the axes' uniform density of 1 / pi
  return std::clamp(kMemory * bit.axis_log_odds + evidence, -kLogOddsLimit, kLogOddsLimit);
}

double FrontBackAmbiguity::frontProbability() const {
  const double reversing =
      (1 - kForward) * std::max(kLeastShare, std::exp(-std::abs(traveled) / kReverseFor));
  const double motion = logForward(traveled, kChanceTravel * kChanceTravel, 1 - reversing);
  return 1 / (1 + std::exp(-(log_odds + shape + walk + motion)));
}

double probabilityForward(double v, double v_variance) {
  return 1 / (1 + std::exp(-logForward(v, v_variance)));
}

void seeWalk(double way, double variance, FrontBackAmbiguity& bit) {
  bit.walk = logForward(way, variance);
}

bool asksForReversal(const FrontBackAmbiguity& bit, double v, double v_variance, HeadingMode mode) {
  return mode == HeadingMode::kSplit &&
         bit.log_odds + bit.shape + bit.walk + logForward(v, v_variance) < kReverseAt;
}

}  // namespace perception
