#include "libperception/lidar/classification/PhantomPrior.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace perception {
namespace {

constexpr auto kThingKind = static_cast<std::size_t>(ClusterKind::kThing);
constexpr auto kPhantomKind = static_cast<std::size_t>(ClusterKind::kPhantom);

/// In precipitation, fog or a cloud, and where a vehicle has just driven on a wet road.
constexpr double kInWeather = 0.1, kInWake = 0.8;

}  // namespace

PhantomPrior::PhantomPrior(const Probabilities& learned)
    : learned_(learned[kPhantomKind] / (learned[kPhantomKind] + learned[kThingKind])) {}

double PhantomPrior::share(const CausesHere& causes) const {
  const double not_clear = std::max(causes.weather, causes.cloud);
  const double air = learned_ + not_clear * std::max(0.0, kInWeather - learned_);
  return air + causes.wake * std::max(0.0, kInWake - air);
}

PhantomPrior::Probabilities PhantomPrior::operator()(const Probabilities& probabilities,
                                                     const CausesHere& causes) const {
  Probabilities p = probabilities;
  if (learned_ <= 0 || learned_ >= 1) return p;
  const double now = share(causes);
  p[kPhantomKind] *= now / learned_;
  p[kThingKind] *= (1 - now) / (1 - learned_);
  const double sum = std::accumulate(p.begin(), p.end(), 0.0);
  for (double& v : p) v /= sum;
  return p;
}

}  // namespace perception
