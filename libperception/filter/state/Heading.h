#pragma once
#include "libperception/measurement/Measurement.h"

namespace perception {

/// How a measured heading that may be reversed is used (method.md 7).
enum class HeadingMode {
  kSplit,  ///< axis and bit apart, the bit as log-odds with a prior that objects drive forward
  kWide,   ///< one Gaussian wide enough for reversals: C/H of [radecki2016], `[run] sensors` = C/H
};

/// What is known of an oriented object's direction along its axis: front or back.
struct FrontBackAmbiguity {
  double log_odds = 0;         ///< that theta is the heading and not its opposite; 0: nothing known
  int same = 0, opposite = 0;  ///< detections that agreed with theta, or not
  double lane = 0;             ///< what a lane gave to the log-odds
  double axis_log_odds = 0;    ///< that theta lies along the object at all; 0: no detector told
  int last = 0;                ///< the last detection: 1 agreed with theta, -1 did not, 0: none yet

  bool measured() const { return same + opposite > 0; }
  FrontBackAmbiguity reversed() const {
    return {-log_odds, opposite, same, -lane, axis_log_odds, -last};
  }
};

/// A measured heading against theta.
struct HeadingResidual {
  double y = 0;         ///< [rad] to the nearer of heading and opposite; `kWide`: to the heading
  double variance = 0;  ///< [rad^2] of the measurement
  bool same = true;     ///< the heading was the nearer one
};
HeadingResidual headingResidual(const MeasuredHeading& seen, double theta, HeadingMode mode);

/// Log density of the measured heading over the uniform one, given theta with `theta_variance`
/// [rad^2]: what it says for this object against clutter, births and objects without a heading.
double logHeadingRatio(const MeasuredHeading& seen, double theta, double theta_variance,
                       HeadingMode mode);

/// The bit of a track that starts from, or is given its orientation by, this measurement.
FrontBackAmbiguity firstFrontBack(const MeasuredHeading& seen);
/// The bit after one more detection. Reversals that come in bursts
/// (MeasuredHeading::flip_persistence) are a chain of two states: what a detection says then
/// depends on the one before.
FrontBackAmbiguity nextFrontBack(const FrontBackAmbiguity& bit, bool same,
                                 const MeasuredHeading& seen);

/// Log-odds that theta, with `theta_variance` [rad^2], lies along the object after one more
/// detection: what it says of the axis against an axis that may be any. Detectors' stray axes bound
/// what a single one can say against it.
double nextAxisLogOdds(const FrontBackAmbiguity& bit, const MeasuredHeading& seen, double theta,
                       double theta_variance);

/// Whether speed v [m/s, m^2/s^2] and bit ask for (v, theta) -> (-v, theta + pi).
bool asksForReversal(const FrontBackAmbiguity& bit, double v, double v_variance, HeadingMode mode);

}  // namespace perception
