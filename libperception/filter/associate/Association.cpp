#include "libperception/filter/associate/Association.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

/// Index of each distinct track in the hypothesis; -1: absent.
std::vector<int> placesOf(const TrackIndices& tracks, const AssociationIndex& index) {
  std::vector<int> place(index.tracks(), -1);
  for (std::size_t i = 0; i < tracks.size(); ++i) place[tracks[i]] = static_cast<int>(i);
  return place;
}

double logAllMissed(const TrackIndices& tracks, const AssociationIndex& index) {
  double sum = 0;
  for (const std::uint32_t t : tracks) sum += index.logMiss(t);
  return sum;
}

/// Candidate causes of a measurement in one hypothesis, with normalized probabilities.
struct Choices {
  std::vector<int> cause;
  std::vector<double> log_odds;
  double total = kMinusInfinity;

  void gather(std::size_t k, const AssociationIndex& index, const std::vector<int>& place,
              const std::vector<int>& taken_by) {
    cause.clear();
    log_odds.clear();
    for (const auto& o : index.others(k))
      cause.push_back(o.cause), log_odds.push_back(o.log_weight);
    for (const auto& c : index.candidates(k)) {
      const int p = place[c.track];
      if (p < 0 || taken_by[static_cast<std::size_t>(p)] >= 0) continue;
      cause.push_back(p);
      log_odds.push_back(c.log_odds);
    }
    total = logSumExp(log_odds);
  }
};

/// Slots with equal samples so far.
struct Branch {
  SampledAssociation sampled;
  std::vector<int> taken_by;  // by place of a track: its measurement or -1
  Rng rng;                    // stream of the first slot

  explicit Branch(const RngKey& key) : rng(key) {}
  void take(std::size_t k, int cause) {
    sampled.association.cause[k] = cause;
    if (cause >= 0) taken_by[static_cast<std::size_t>(cause)] = static_cast<int>(k);
  }
};

/// By cause the slots that draw it, ascending. The draws are stratified: n slots take the n evenly
/// spaced quantiles from a random one on, around the circle. Each slot draws each cause with its
/// probability, and the causes get their shares of the slots but for one.
std::vector<std::vector<std::uint32_t>> drawn(const Choices& choices,
                                              const std::vector<std::uint32_t>& slots, Rng& rng) {
  const double begin = rng.uniform(), step = 1 / static_cast<double>(slots.size());
  std::vector<std::vector<std::uint32_t>> parts(choices.cause.size());
  std::size_t chosen = 0;
  double end = std::exp(choices.log_odds[0] - choices.total);  // of the chosen cause's quantiles
  bool around = false;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    double quantile = begin + static_cast<double>(i) * step;
    if (quantile >= 1) {  // once around the circle: from the first cause on
      if (!around) chosen = 0, end = std::exp(choices.log_odds[0] - choices.total);
      around = true;
      quantile -= 1;
    }
    while (quantile >= end && chosen + 1 < parts.size())
      end += std::exp(choices.log_odds[++chosen] - choices.total);
    parts[chosen].push_back(slots[i]);
  }
  return parts;
}

/// Splits the slots of `branch` by their sample for measurement k; all but the first part are
/// appended to `out`. `key`: of the scan's draws.
void split(std::size_t k, const Choices& choices, const RngKey& key, Branch& branch,
           std::vector<Branch>& out) {
  branch.sampled.association.log_weight += choices.total;
  if (choices.cause.size() == 1) {
    branch.take(k, choices.cause[0]);
    return;
  }
  auto parts = drawn(choices, branch.sampled.slots, branch.rng);
  const std::uint32_t first_slot = branch.sampled.slots.front();
  std::size_t same = 0;  // the part that goes on with the branch's stream
  while (parts[same].empty() || parts[same].front() != first_slot) ++same;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    if (c == same || parts[c].empty()) continue;
    out.push_back(branch);
    out.back().rng = Rng(key.withSlot(parts[c].front()));
    out.back().sampled.slots = std::move(parts[c]);
    out.back().take(k, choices.cause[c]);
  }
  branch.sampled.slots = std::move(parts[same]);
  branch.take(k, choices.cause[same]);
}

}  // namespace

AssociationIndex::AssociationIndex(const std::vector<Track>& predicted,
                                   const LikelihoodTable& table, const FilterModel& model)
    : by_measurement_(table.births.size()), others_(table.births.size()) {
  const bool decays = model.params.existence_decay > 0;
  log_miss_.reserve(predicted.size());
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const double r = predicted[i].existence;
    // With exponential decay (DUC) existence neither weighs nor is weighed by detections.
    log_miss_.push_back(decays ? 0 : std::log1p(-r * table.tracks[i].seen));
    for (const auto& pair : table.tracks[i].pairs) {
      const double log_odds =
          pair.log_likelihood + pair.log_prior + (decays ? 0 : std::log(r) - log_miss_.back());
      by_measurement_[pair.measurement].push_back({i, log_odds});
    }
  }
  for (std::size_t k = 0; k < table.births.size(); ++k) {
    const auto& n = table.births[k];
    if (model.params.sampled_births) {
      others_[k] = {{Association::kClutter, n.log_clutter}, {Association::kNew, n.log_birth}};
    } else {
      others_[k] = {{Association::kNew, n.log_new}};
    }
  }
}

std::vector<SampledAssociation> sampleAssociations(const TrackIndices& tracks,
                                                   const AssociationIndex& index,
                                                   const std::vector<std::size_t>& order,
                                                   std::vector<std::uint32_t> slots,
                                                   const RngKey& key) {
  const std::vector<int> place = placesOf(tracks, index);
  std::vector<Branch> branches(1, Branch(key.withSlot(slots.front())));
  Branch& root = branches.front();
  root.taken_by.assign(tracks.size(), -1);
  root.sampled.association.cause.assign(index.measurements(), Association::kNew);
  root.sampled.association.log_weight = logAllMissed(tracks, index);
  root.sampled.slots = std::move(slots);
  Choices choices;
  for (const std::size_t k : order) {
    const std::size_t before = branches.size();
    for (std::size_t b = 0; b < before; ++b) {
      choices.gather(k, index, place, branches[b].taken_by);
      if (choices.total == kMinusInfinity)
        continue;  // zero density under every cause: ignored as unmodeled clutter
      Branch branch = std::move(branches[b]);
      split(k, choices, key, branch, branches);
      branches[b] = std::move(branch);
    }
  }
  std::vector<SampledAssociation> out;
  out.reserve(branches.size());
  for (Branch& b : branches) {
    for (int& c : b.sampled.association.cause)
      if (c >= 0) c = static_cast<int>(tracks[static_cast<std::size_t>(c)]);
    out.push_back(std::move(b.sampled));
  }
  return out;
}

std::vector<std::size_t> randomOrder(std::size_t n, Rng rng) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
  return order;
}

}  // namespace perception
