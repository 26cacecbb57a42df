#pragma once
#include <array>

#include "libperception/lidar/ClusterKind.h"
#include "libperception/measurement/PhantomCauses.h"

namespace perception {

/// Share of phantoms among the clusters that are no road users: it differs by orders of magnitude
/// between clear air and snowfall or the spray behind a car, and with it what a cluster that looks
/// like spray is worth. It follows from the probability of a physical cause and never from how the
/// clusters of the scan look (method.md 8.10).
class PhantomPrior {
 public:
  using Probabilities = std::array<double, kClusterKinds>;

  /// `learned`: shares of the kinds for which a classifier's probabilities hold.
  explicit PhantomPrior(const Probabilities& learned);

  /// The share at a place; without a cause that of the classifier's samples.
  double share(const CausesHere& causes) const;
  /// A classifier's probabilities under that share; their sum is 1.
  Probabilities operator()(const Probabilities& probabilities, const CausesHere& causes) const;

 private:
  double learned_;
};

}  // namespace perception
