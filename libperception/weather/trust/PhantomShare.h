#pragma once
#include "libperception/weather/trust/SuspectReturns.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

/// The share of phantoms among the returns near the sensor, adapted from scan to scan by
/// expectation maximization [saerens2002], method.md (60).
class PhantomShare {
 public:
  explicit PhantomShare(const TrustParams& params);

  /// Updates the share by a scan; `near`: number of its returns within share_range, suspects or
  /// not.
  void follow(const SuspectReturns& suspects, int near);
  /// [log-odds] correction of the fitted prior.
  double logOdds() const;
  double value() const { return share_; }  ///< [-]

 private:
  bool adapts_;
  double fitted_, range_, memory_, gain_, least_;  // as TrustParams
  double share_;
  bool started_ = false;
};

}  // namespace perception
