#include "libperception/filter/update/Smoothing.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

/// Chi-square quantile 1 - 1e-6, four degrees of freedom: a later state farther from the prediction
/// means that the filter was reinitialized in between.
constexpr double kBroken = 33.38;
constexpr double kLeastClass = 1e-4;  // classes less likely than this keep their filtered state
constexpr double kRegular = 1e-12;    // [SI units] regularizes the covariance of static objects

/// Predicted state of a class filter and its cross-covariance with the current one.
struct JointPrediction {
  Vector4 x;
  Matrix4 P;
  Matrix4 cross;  // covariance of the state before with the state after
};

Vector4 stateDifference(const Vector4& a, const Vector4& b, bool oriented) {
  Vector4 d = a - b;
  if (oriented) d[3] = wrapAngle(d[3]);
  return d;
}

JointPrediction predictJointly(const ObjectClass& c, double dt, const ClassFilter& before) {
  ClassFilter f = before;
  std::vector<GaussianStep> steps;
  listSteps(c, dt, f, steps);
  Matrix4 F;
  if (f.modes.empty()) {
    predictGaussian(steps[0], &F);
    return {f.x, f.P, before.P * F.transpose()};
  }
  const std::vector<ModeFilter> mixed = f.modes;  // each the start of its own mode's step
  std::vector<Matrix4> transitions(mixed.size());
  for (std::size_t i = 0; i < mixed.size(); ++i) predictGaussian(steps[i], &transitions[i]);
  combineModes(f);
  JointPrediction out{f.x, f.P, Matrix4::Zero()};
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    const Vector4 from = stateDifference(mixed[i].x, before.x, before.oriented);
    const Vector4 to = stateDifference(f.modes[i].x, f.x, f.oriented);
    out.cross += std::exp(mixed[i].log_probability) *
                 (mixed[i].P * transitions[i].transpose() + from * to.transpose());
  }
  return out;
}

/// One backward step: `f` from filtered to smoothed.
void smoothFilter(const ObjectClass& c, double dt, const ClassFilter& newer, ClassFilter& f) {
  f.extent = newer.extent;
  if (f.oriented && !newer.oriented) return;  // started anew in between
  if (f.oriented && std::abs(wrapAngle(newer.x[3] - f.x[3])) > kPi / 2) reverse(f);
  const JointPrediction predicted = predictJointly(c, dt, f);
  Vector4 x = newer.x;
  Matrix4 P = newer.P;
  const bool found_heading = newer.oriented && !f.oriented;
  if (found_heading) {
    const Kinematics k = kinematicsOf(c, newer);
    const Matrix4 J = k.J.topRows<4>();
    x = k.q.head<4>();
    P = J * newer.P * J.transpose();
  }
  const Vector4 d = stateDifference(x, predicted.x, f.oriented);
  const Eigen::LLT<Matrix4> llt(predicted.P + kRegular * Matrix4::Identity());
  if (llt.info() != Eigen::Success || d.dot(llt.solve(d)) > kBroken) return;
  const Matrix4 G = llt.solve(predicted.cross.transpose()).transpose();
  f.x += G * d;
  f.P += G * (P - predicted.P) * G.transpose();
  f.P = (0.5 * (f.P + f.P.transpose())).eval();
  f.modes.clear();
  if (f.oriented) f.x[3] = wrapAngle(f.x[3]);
  if (found_heading) orientAlong(newer.x[3], newer.P(3, 3) + c.yawRatePsd(newer.x[2]) * dt, f);
  if (newer.oriented) f.heading = newer.heading;
}

/// Backward recursion of the class chain (method.md 5.7): p(c) sum over later classes of p(later |
/// c) smoothed(later) / predicted(later).
void smoothClasses(const Track& newer, const TrackOdds& predicted, double forget, Track& track) {
  const std::size_t n = track.log_class.size();
  std::vector<double> ratio(n, kMinusInfinity);
  for (std::size_t j = 0; j < n; ++j) {
    if (newer.log_class[j] > kMinusInfinity && predicted.log_class[j] > kMinusInfinity)
      ratio[j] = newer.log_class[j] - predicted.log_class[j];
  }
  const double other = std::log(forget / static_cast<double>(n)) + logSumExp(ratio);
  for (std::size_t j = 0; j < n; ++j)
    track.log_class[j] += logAddExp(std::log1p(-forget) + ratio[j], other);
  logNormalize(track.log_class);
}

/// Backward recursion of a random walk: its variance grows by `walk`; `d`: later estimate minus
/// this one.
void smoothScalar(double d, double later_variance, double walk, ScalarEstimate& e) {
  const double predicted = e.variance + walk, gain = e.variance / predicted;
  e.mean += gain * d;
  e.variance += gain * gain * (later_variance - predicted);
}

void smoothBodyHeading(const Track& newer, double walk, Track& track) {
  if (!newer.body_heading) return;
  if (!track.body_heading) {
    track.body_heading = {newer.body_heading->mean, newer.body_heading->variance + walk};
  } else {
    double d = wrapAngle(newer.body_heading->mean - track.body_heading->mean);
    if (std::abs(d) > kPi / 2) {  // the heading was reversed until then
      track.body_heading->mean += kPi;
      d = wrapAngle(d + kPi);
    }
    smoothScalar(d, newer.body_heading->variance, walk, *track.body_heading);
    track.body_heading->mean = wrapAngle(track.body_heading->mean);
  }
  track.body_heading_bit = newer.body_heading_bit;
}

/// Smooths `filtered` with `newer`, its smoothed successor.
Track smoothedBefore(const Track& filtered, const Track& newer, const FilterModel& model) {
  const double dt = newer.stamp - filtered.stamp;
  Track track = filtered;
  track.id = newer.id;
  track.birth = newer.birth;
  track.phantom = newer.phantom;  // the cause stays the same
  // What is known of it by now.
  track.hits = newer.hits, track.missed = newer.missed;
  track.height = newer.height;
  if (dt <= 0) {
    track.bank = newer.bank;
    track.decided_class = newer.decided_class;
    track.log_class = newer.log_class;
    track.existence = newer.existence;
    track.base_z = newer.base_z;
    track.body_heading = newer.body_heading, track.body_heading_bit = newer.body_heading_bit;
    return track;
  }
  const TrackOdds predicted = predictOdds(filtered, newer.stamp, model);
  smoothClasses(newer, predicted, -std::expm1(-dt / model.params.class_forgetting), track);
  // An object that exists later existed before; one that does not may have disappeared in between.
  const double survival = predicted.existence / std::max(filtered.existence, 1e-300);
  const double gone_since =
      filtered.existence * (1 - survival) / std::max(1 - predicted.existence, 1e-12);
  track.existence = newer.existence + (1 - newer.existence) * std::min(1.0, gone_since);
  smoothScalar(newer.base_z.mean - track.base_z.mean, newer.base_z.variance,
               model.params.base_walk * dt, track.base_z);
  smoothBodyHeading(newer, model.params.body_heading_walk * dt, track);
  const ClassId best = track.likeliestClass();
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    const bool counts = j == best || track.log_class[i] > std::log(kLeastClass);
    if (counts && track.live(j) && newer.live(j))
      smoothFilter(model.classes[j], dt, newer.bank[i], track.bank[i]);
  }
  return track;
}

}  // namespace

std::optional<Track> smoothedTrack(const Track& now, Stamp at, const FilterModel& model) {
  if (now.birth > at) return std::nullopt;
  Track track = now;
  for (TrackHandle older = now.previous.lock(); older && track.stamp > at;
       older = older->previous.lock()) {
    // `at` may lie between two scans.
    track =
        smoothedBefore(older->stamp < at ? predictTrack(*older, at, model) : *older, track, model);
  }
  return track;
}

}  // namespace perception
