#include "libperception/lidar/PhantomMix.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace perception {
namespace {

constexpr auto kThingKind = static_cast<std::size_t>(ClusterKind::kThing);
constexpr auto kPhantomKind = static_cast<std::size_t>(ClusterKind::kPhantom);

/// Clusters that the prior counts for (assumed): a scan has 5 to 300.
constexpr double kPriorClusters = 20;
constexpr double kMostShare = 0.9;  // things are never out of the question (assumed)
constexpr int kMixSteps = 20;       // of expectation maximization

}  // namespace

PhantomMix::PhantomMix(const std::vector<Probabilities>& clusters, const Probabilities& prior)
    : prior_share_(prior[kPhantomKind] / (prior[kPhantomKind] + prior[kThingKind])),
      share_(prior_share_) {
  for (int step = 0; step < kMixSteps; ++step) {
    double phantoms = kPriorClusters * prior_share_, all = kPriorClusters;
    for (const Probabilities& raw : clusters) {
      const Probabilities p = (*this)(raw);
      phantoms += p[kPhantomKind], all += p[kPhantomKind] + p[kThingKind];
    }
    share_ = std::max(prior_share_, std::min(phantoms / all, kMostShare));
  }
}

PhantomMix::Probabilities PhantomMix::operator()(const Probabilities& probabilities) const {
  Probabilities p = probabilities;
  if (prior_share_ <= 0 || prior_share_ >= 1) return p;
  p[kPhantomKind] *= share_ / prior_share_;
  p[kThingKind] *= (1 - share_) / (1 - prior_share_);
  const double sum = std::accumulate(p.begin(), p.end(), 0.0);
  for (double& v : p) v /= sum;
  return p;
}

}  // namespace perception
