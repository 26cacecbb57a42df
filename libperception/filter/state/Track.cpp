#include "libperception/filter/state/Track.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/filter/state/IndexMap.h"

namespace perception {

ClassId Track::likeliestClass() const {
  return static_cast<ClassId>(std::max_element(log_class.begin(), log_class.end()) -
                              log_class.begin());
}

double Track::shareOfEvidence() const {
  constexpr double kFree = 1;  // hit that may be taken as seen before (assumed)
  const double seen = kFree + std::accumulate(hits.begin(), hits.end(), 0);
  return seen / (seen + missed);
}

TrackList::TrackList(TrackTable tracks) : places_(tracks.size()) {
  std::iota(places_.begin(), places_.end(), 0u);
  table_ = std::make_shared<const TrackTable>(std::move(tracks));
}

std::uint64_t historyKey(const Track& track) {
  return mixBits(track.history + 0x9E3779B97F4A7C15ull);
}

Hypothesis::Hypothesis(TrackTable t) : tracks(std::move(t)) {
  for (const auto& track : tracks) key += historyKey(*track);
}

std::uint64_t extendHistory(std::uint64_t history, std::uint64_t scan, std::size_t measurement) {
  return mixBits(history ^ (birthId(scan, measurement) + 0x9E3779B97F4A7C15ull));
}

std::uint64_t sensorKey(const std::string& label) {
  std::uint64_t h = 0xcbf29ce484222325u;
  for (const char c : label) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return h;
}

std::vector<double> classProbabilities(const Track& track) {
  std::vector<double> p(track.log_class.size());
  std::transform(track.log_class.begin(), track.log_class.end(), p.begin(),
                 [](double lp) { return std::exp(lp); });
  return p;
}

std::vector<double> classProbabilities(const Track& track, const ClassTable& classes) {
  std::vector<double> p = classProbabilities(track);
  const double share = track.shareOfEvidence();
  if (share >= 1) return p;
  double sum = 0;
  for (ClassId j = 0; j < classes.size(); ++j) {
    double& own = p[static_cast<std::size_t>(j)];
    own = std::pow(own, share) * std::pow(classes[j].prior, 1 - share);
    sum += own;
  }
  for (double& own : p) own /= sum;
  return p;
}

}  // namespace perception
