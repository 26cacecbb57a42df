#pragma once
#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {

/// From where an object was seen, and how well. Views alike err alike.
struct EvidenceView {
  double bearing = 0;    ///< [rad] of the line from the object to the sensor, world
  double log_range = 0;  ///< log of the range [m]
  double returns = 1;    ///< that show the object: its weight in the mean of all views
};

/// Errors of a sensor's evidence of one object's class (method.md 5.6, fitted as in 8.10). One part
/// stays, since the object looks unlike its kind; the other part changes with the view.
struct EvidenceMemory {
  double lasting = 0.2;    ///< [0, 1) share of the part that stays in the variance
  double kept = 0.9;       ///< [0, 1) correlation of the other part in views alike
  double bearing = 0.2;    ///< [rad] change by which it falls to 1/e
  double log_range = 0.3;  ///< [-] the same of the log of the range
  double time = 1;         ///< [s] the same of time
  /// [rad] change of bearing, or change of the log of the range, by which the say of earlier views
  /// falls to 1/e: an object that comes near is judged anew.
  double renewal = 0.5;
  /// Returns that have .6 of the say for a pedestrian, five times as many all of it: posts, trunks
  /// and signs of few returns look like people again and again. 0: any number has all of it.
  double few_of_pedestrian = 0;

  /// Of what speaks for a pedestrian.
  double pedestrianWeight(double returns) const {
    return std::min(1.0, 1.2 * returns / (returns + few_of_pedestrian));
  }
  /// Of the changing part.
  double correlation(const EvidenceView& a, const EvidenceView& b, double seconds) const {
    return kept *
           std::exp(-std::abs(wrapAngle(a.bearing - b.bearing)) / bearing -
                    std::abs(a.log_range - b.log_range) / log_range - std::abs(seconds) / time);
  }
  /// Say that a view keeps when the next one is from there.
  double say(const EvidenceView& a, const EvidenceView& b) const {
    return std::exp(
        -(std::abs(wrapAngle(a.bearing - b.bearing)) + std::abs(a.log_range - b.log_range)) /
        renewal);
  }
  /// Independent looks that one more view is worth when the changing part of its error has the
  /// correlation r with that of the last.
  static double worth(double r) { return (1 - r) / (1 + r); }
  /// Independent looks that `views` looks of independent changing parts are worth, at most
  /// 1 / lasting.
  double looks(double views) const { return views / (1 + lasting * (views - 1)); }
};

}  // namespace perception
