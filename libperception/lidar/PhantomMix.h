#pragma once
#include <array>
#include <vector>

#include "libperception/lidar/ClusterKind.h"

namespace perception {

/// Share of phantoms among the clusters of a scan that are no road users: it differs by orders of
/// magnitude between clear air and the spray behind a car, and with it what a cluster that looks
/// like spray is worth. Found by expectation maximization [saerens2002] from the probabilities of
/// the scan's clusters, beside those of a classifier for its training samples; at least that of
/// these samples, so that clear air is judged as the classifier learned it: method.md 8.10.
class PhantomMix {
 public:
  using Probabilities = std::array<double, kClusterKinds>;

  /// `prior`: shares of the kinds for which the probabilities hold; `clusters`: probabilities of
  /// the scan's clusters, wholes alone.
  PhantomMix(const std::vector<Probabilities>& clusters, const Probabilities& prior);

  /// The probabilities under the share of this scan; their sum is 1.
  Probabilities operator()(const Probabilities& probabilities) const;
  double share() const { return share_; }  ///< [0, 1]

 private:
  double prior_share_, share_;
};

}  // namespace perception
