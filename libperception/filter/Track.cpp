#include "libperception/filter/Track.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {

ClassId Track::likeliestClass() const {
  return static_cast<ClassId>(std::max_element(log_class.begin(), log_class.end()) -
                              log_class.begin());
}

namespace {

/// splitmix64's finaliser: a bijection of 64-bit numbers that looks random.
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

}  // namespace

Hypothesis::Hypothesis(std::vector<TrackHandle> t) : tracks(std::move(t)) {
  for (const auto& track : tracks) key += mix(track->history + 0x9E3779B97F4A7C15ull);
}

std::uint64_t extendHistory(std::uint64_t history, std::uint64_t scan, std::size_t measurement) {
  return mix(history ^ (birthId(scan, measurement) + 0x9E3779B97F4A7C15ull));
}

std::vector<double> classProbabilities(const Track& track) {
  std::vector<double> p(track.log_class.size());
  std::transform(track.log_class.begin(), track.log_class.end(), p.begin(),
                 [](double lp) { return std::exp(lp); });
  return p;
}

}  // namespace perception
