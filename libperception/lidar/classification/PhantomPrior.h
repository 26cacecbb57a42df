#pragma once
#include <array>

#include "libperception/lidar/description/ClusterKind.h"
#include "libperception/measurement/frames/PhantomCauses.h"

namespace perception {

/// Share of phantoms among the clusters that are not road users. It differs by orders of magnitude
/// between clear air and snowfall or the spray behind a car, and it decides how much it means that
/// a cluster looks like spray. It follows from the probability of a physical cause, and never from
/// what the clusters of the scan look like (method.md 8.10).
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
