#pragma once
#include "libperception/weather/SuspectReturns.h"
#include "libperception/weather/TrustParams.h"

namespace perception {

/// The share of phantoms among the returns near the sensor, which follows the weather by
/// expectation maximization from scan to scan [saerens2002].
class PhantomShare {
 public:
  explicit PhantomShare(const TrustParams& params);

  /// A scan, of which `near` returns lie within share_range, those that are no suspects included.
  void follow(const SuspectReturns& suspects, int near);
  /// [log-odds] that the weather adds to what was fitted.
  double logOdds() const;
  double value() const { return share_; }  ///< [-]

 private:
  bool adapts_;
  double fitted_, range_, memory_, gain_, least_;  // as TrustParams
  double share_;
  bool started_ = false;
};

}  // namespace perception
