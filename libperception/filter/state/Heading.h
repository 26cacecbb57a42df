#pragma once
#include "libperception/measurement/Measurement.h"

namespace perception {

/// Use of measured headings that may be reversed by 180 degrees (method.md 7).
enum class HeadingMode {
  kSplit,  ///< axis and front/back bit separately; the bit as log-odds with a prior for driving
           ///< forward
  kWide,   ///< one Gaussian wide enough to cover reversals: C/H of [radecki2016], `[run] sensors` =
           ///< C/H
};

/// Front/back ambiguity of an oriented object: log-odds and counts of detections.
struct FrontBackAmbiguity {
  double log_odds = 0;         ///< that theta is the heading and not its opposite; 0: unknown
  int same = 0, opposite = 0;  ///< detections that agreed with theta, or not
  double lane = 0;             ///< contribution of the lane prior to log_odds
  double axis_log_odds =
      0;                ///< that theta is the axis of the object; 0: no detection with a heading
  int last = 0;         ///< the last detection: 1 agreed with theta, -1 did not, 0: none yet
  bool driven = false;  ///< it has surely moved along theta
  double traveled = 0;  ///< [m] along theta since it is known; negative: against it
  double shape = 0;     ///< mean of PartialBox::front_log_odds along theta over its views
  int views = 0;        ///< that told a front by the shape, up to a limit
  double walk = 0;  ///< log-odds that theta points the way in which the person last surely walked

  bool measured() const { return same + opposite > 0; }
  FrontBackAmbiguity reversed() const {
    return {-log_odds, opposite,  same,   -lane, axis_log_odds, -last,
            driven,    -traveled, -shape, views, -walk};
  }
  /// Probability that theta points to the front, from detections, lanes, the shape and the way that
  /// it has traveled, which vehicles do forward 97 % of the time, and the more
  /// surely the farther they go; .5: unknown.
  double frontProbability() const;
};

/// Residual of a measured heading.
struct HeadingResidual {
  double y =
      0;  ///< [rad] from theta to the nearer of heading and opposite; `kWide`: to the heading
  double variance = 0;  ///< [rad^2] of the measurement
  bool same = true;     ///< false: the opposite was nearer
};
HeadingResidual headingResidual(const MeasuredHeading& seen, double theta, HeadingMode mode);

/// log of p(measured heading | theta, `theta_variance` [rad^2]) over the uniform density, which
/// holds for clutter, births and objects without a heading.
double logHeadingRatio(const MeasuredHeading& seen, double theta, double theta_variance,
                       HeadingMode mode);

/// Front/back bit of a track that is born from, or oriented by, this measurement.
FrontBackAmbiguity firstFrontBack(const MeasuredHeading& seen);
/// Front/back bit after one more detection. Correlated reversals
/// (MeasuredHeading::flip_persistence) are a two-state Markov chain: the likelihood depends on the
/// previous detection.
FrontBackAmbiguity nextFrontBack(const FrontBackAmbiguity& bit, bool same,
                                 const MeasuredHeading& seen);

/// Counts one more view of an object by its shape: the log-odds that theta points to the front.
/// Views of one object err alike, so their mean counts and not their sum.
void seeShape(double front_log_odds, FrontBackAmbiguity& bit);

/// Share of stray axes, uniform instead of within their deviation of the object's: 1 % of Geiger's
/// on KITTI lie beyond 22.5 deg (method.md 7).
inline constexpr double kStrayAxes = 0.01;

/// axis_log_odds after one more detection: likelihood of the measured axis given theta with
/// `theta_variance` [rad^2] against a uniform axis. The share `stray` of stray axes bounds the
/// evidence of a single detection against theta.
double nextAxisLogOdds(const FrontBackAmbiguity& bit, const MeasuredHeading& seen, double theta,
                       double theta_variance, double stray = kStrayAxes);

/// Probability that an object without a heading in its state faces the way it moves, with a speed
/// of v [m/s] and its variance [m^2/s^2].
double probabilityForward(double v, double v_variance);
/// Sets the log-odds of a person's front by the way [m] that the person has walked along theta
/// (negative: against it), with its variance [m^2]: people face the way they walk.
void seeWalk(double way, double variance, FrontBackAmbiguity& bit);

/// Whether (v, theta) -> (-v, theta + pi) agrees better with speed v [m/s], its variance [m^2/s^2]
/// and the front/back bit.
bool asksForReversal(const FrontBackAmbiguity& bit, double v, double v_variance, HeadingMode mode);

}  // namespace perception
