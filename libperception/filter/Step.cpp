#include "libperception/filter/Step.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/LogMath.h"
#include "libperception/core/system/Parallel.h"
#include "libperception/filter/associate/Association.h"
#include "libperception/filter/associate/RankedChildren.h"
#include "libperception/filter/likelihood/Gating.h"
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/IndexMap.h"
#include "libperception/filter/update/UpdateCache.h"

namespace perception {
namespace {

enum Purpose : std::uint32_t { kOrder = 0x5701, kSample = 0x5702 };

/// The address behind a handle as a key.
template <class T>
std::uint64_t keyOf(const T* p) {
  return static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(p));
}

/// The hypotheses before the scan, each distinct one once.
struct DistinctHypotheses {
  std::vector<const Hypothesis*> hypotheses;  // in order of first appearance
  std::vector<std::size_t> of_slot;           // index of the slot's hypothesis

  explicit DistinctHypotheses(const Posterior& before) {
    IndexMap numbers(before.hypotheses.size());
    of_slot.reserve(before.hypotheses.size());
    for (const auto& h : before.hypotheses) {
      const auto [number, fresh] = numbers.numberOf(keyOf(h.get()));
      if (fresh) hypotheses.push_back(h.get());
      of_slot.push_back(number);
    }
  }

  /// By hypothesis the slots that hold it, ascending.
  std::vector<std::vector<std::uint32_t>> slots() const {
    std::vector<std::vector<std::uint32_t>> out(hypotheses.size());
    for (std::size_t i = 0; i < of_slot.size(); ++i)
      out[of_slot[i]].push_back(static_cast<std::uint32_t>(i));
    return out;
  }
};

/// Numbers the tracks in order of first appearance, so never by address.
class TrackIndexMap {
 public:
  TrackIndexMap(const std::vector<const Hypothesis*>& hypotheses, std::vector<TrackHandle>& tracks)
      : tracks_(tracks), by_key_(64) {
    for (const Hypothesis* h : hypotheses) {
      if (!h->tracks.table() || h->tracks.table() == table_) continue;
      one_table_ = table_ == nullptr;
      table_ = h->tracks.table();
      if (!one_table_) break;
    }
    if (table_ && one_table_) by_place_.assign(table_->size(), kNone);
  }

  TrackIndices of(const TrackList& list) {
    TrackIndices out;
    out.reserve(list.size());
    for (const std::uint32_t place : list.places()) {
      std::uint32_t number = 0;
      if (one_table_) {
        if (by_place_[place] == kNone) {
          by_place_[place] = static_cast<std::uint32_t>(tracks_.size());
          tracks_.push_back((*table_)[place]);
        }
        number = by_place_[place];
      } else {
        const TrackHandle& track = (*list.table())[place];
        const auto [key_number, fresh] = by_key_.numberOf(keyOf(track.get()));
        if (fresh) tracks_.push_back(track);
        number = static_cast<std::uint32_t>(key_number);
      }
      out.push_back(number);
    }
    return out;
  }

 private:
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
  std::vector<TrackHandle>& tracks_;
  const TrackTable* table_ = nullptr;
  bool one_table_ = true;  // as after step(); posteriors from elsewhere may have several
  std::vector<std::uint32_t> by_place_;
  IndexMap by_key_;
};

/// Lists the distinct tracks and predicts those that the scan concerns.
ScanTracks tracksOf(const std::vector<const Hypothesis*>& hypotheses, const MeasurementScan& scan,
                    const FilterModel& model) {
  ScanTracks out;
  TrackIndexMap numbers(hypotheses, out.before);
  out.of_hypothesis.reserve(hypotheses.size());
  out.hypotheses = hypotheses;
  for (const Hypothesis* h : hypotheses) out.of_hypothesis.push_back(numbers.of(h->tracks));
  out.touched.assign(out.before.size(), 0);
  const bool position_only = isPositionOnly(scan);
  parallelFor(out.before.size(), [&](std::size_t i) {
    out.touched[i] = mayBeInView(scan, *out.before[i], position_only);
  });
  out.predicted = predictTracks(out.before, out.touched, scan.state.stamp, model);
  return out;
}

/// An association of one distinct hypothesis, the slots that drew it (sampled) and its log weight
/// (ranked).
struct Child {
  std::size_t parent = 0;
  Association association;
  std::vector<std::uint32_t> slots;
  double log_weight = 0;
};

std::vector<Child> sampleChildren(const DistinctHypotheses& groups, const ScanTracks& tracks,
                                  const AssociationIndex& index, const RngKey& key) {
  const auto order = randomOrder(index.measurements(), Rng(key.withPurpose(kOrder)));
  std::vector<std::vector<SampledAssociation>> sampled(groups.hypotheses.size());
  const auto slots = groups.slots();
  parallelFor(sampled.size(), [&](std::size_t h) {
    sampled[h] = sampleAssociations(tracks.of_hypothesis[h], index, order, slots[h],
                                    key.withPurpose(kSample));
  });
  std::vector<Child> children;
  for (std::size_t h = 0; h < sampled.size(); ++h) {
    for (auto& s : sampled[h])
      children.push_back({h, std::move(s.association), std::move(s.slots), 0});
  }
  return children;
}

/// The best `slots` children over all hypotheses.
std::vector<Child> rankedChildren(const DistinctHypotheses& groups,
                                  const std::vector<double>& log_weights, const ScanTracks& tracks,
                                  const AssociationIndex& index, const FilterModel& model,
                                  std::size_t slots) {
  const bool nearest = model.proposal == Proposal::kNearest;
  RankingLimits limits;
  limits.children = nearest ? 1 : static_cast<std::size_t>(model.params.ranked_children);
  limits.slots = nearest ? 1 : slots;
  limits.span = model.params.ranked_span;
  std::vector<double> weights(groups.hypotheses.size(), kMinusInfinity);
  for (std::size_t s = 0; s < groups.of_slot.size(); ++s) {
    double& weight = weights[groups.of_slot[s]];
    weight = logAddExp(weight, log_weights[s]);
  }
  std::vector<Child> children;
  for (auto& c : rankChildren(tracks.of_hypothesis, weights, index, limits))
    children.push_back({c.parent, std::move(c.association), {}, c.log_weight});
  return children;
}

/// By measurement the posterior probability that a track of before the scan is its cause.
std::vector<double> shareOfTracks(const std::vector<Child>& children, const Posterior& before,
                                  bool sampled, std::size_t measurements) {
  std::vector<double> log_weights, slots;
  log_weights.reserve(children.size());
  for (const Child& c : children) {
    slots.clear();
    for (const std::uint32_t s : c.slots)
      slots.push_back(before.log_weights[s] + c.association.log_weight);
    log_weights.push_back(sampled ? logSumExp(slots) : c.log_weight);
  }
  const double all = logSumExp(log_weights);
  std::vector<double> share(measurements, 0);
  if (!std::isfinite(all)) return share;
  for (std::size_t c = 0; c < children.size(); ++c) {
    const double weight = std::exp(log_weights[c] - all);
    for (std::size_t k = 0; k < measurements; ++k)
      if (children[c].association.cause[k] >= 0) share[k] += weight;
  }
  return share;
}

/// Children of equal history share a handle (sampled: slots stay) or become one (ranked).
Posterior posteriorOf(std::vector<Child> children, std::vector<HypothesisHandle> handles,
                      const Posterior& before, bool sampled) {
  IndexMap numbers(children.size());  // by the hypotheses' keys
  Posterior after;
  if (sampled) {
    after.hypotheses.resize(before.hypotheses.size());
    after.log_weights = before.log_weights;
    std::vector<std::size_t> originals;
    for (std::size_t c = 0; c < children.size(); ++c) {
      const auto [number, fresh] = numbers.numberOf(handles[c]->key);
      if (fresh) originals.push_back(c);
      const std::size_t original = originals[number];
      for (const std::uint32_t slot : children[c].slots) {
        after.hypotheses[slot] = handles[original];
        after.log_weights[slot] += children[c].association.log_weight;
      }
    }
    return after;
  }
  for (std::size_t c = 0; c < children.size(); ++c) {
    const auto [number, fresh] = numbers.numberOf(handles[c]->key);
    if (fresh) {
      after.hypotheses.push_back(handles[c]);
      after.log_weights.push_back(children[c].log_weight);
    } else {
      double& w = after.log_weights[number];
      w = logAddExp(w, children[c].log_weight);
    }
  }
  return after;
}

}  // namespace

Posterior Posterior::empty(std::size_t n) {
  const auto nothing = std::make_shared<const Hypothesis>();
  return {std::vector<HypothesisHandle>(n, nothing), std::vector<double>(n, 0.0)};
}

StepResult step(const Posterior& before, const MeasurementScan& scan, const FilterModel& model,
                const RngKey& key, std::size_t slots) {
  const DistinctHypotheses groups(before);
  ScanTracks tracks = tracksOf(groups.hypotheses, scan, model);
  const LikelihoodTable table = likelihoodTable(tracks.predicted, tracks.touched, scan, model);
  const AssociationIndex index(tracks.predicted, table, model);
  const bool sampled = model.proposal == Proposal::kSampled;
  std::vector<Child> children =
      sampled ? sampleChildren(groups, tracks, index, key)
              : rankedChildren(groups, before.log_weights, tracks, index, model, slots);

  UpdateCache updates(tracks, table, scan, model);
  for (const Child& c : children) updates.request(c.parent, c.association);
  StepResult result;
  result.stats.updates = updates.compute(key.counter);
  std::vector<HypothesisHandle> handles(children.size());
  parallelFor(children.size(), [&](std::size_t c) { handles[c] = updates.hypothesis(c); });
  result.stats.measurements = scan.measurements.size();
  result.stats.distinct_tracks = tracks.before.size();
  for (std::size_t t = 0; t < tracks.before.size(); ++t) {
    result.stats.predicted += tracks.touched[t] != 0;
    result.stats.pairs += table.tracks[t].pairs.size();
  }
  result.stats.of_tracks = shareOfTracks(children, before, sampled, scan.measurements.size());
  result.posterior = posteriorOf(std::move(children), std::move(handles), before, sampled);
  return result;
}

MapHypothesis mapHypothesis(const Posterior& posterior) {
  struct Group {
    std::size_t first;
    double most;     // of its slots' log weights
    double sum = 0;  // of its slots' weights, as shares of the largest one
  };
  const std::vector<double>& weights = posterior.log_weights;
  IndexMap numbers(posterior.hypotheses.size());
  std::vector<Group> groups;  // in order of first appearance
  std::vector<std::size_t> of_slot;
  of_slot.reserve(weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto [number, fresh] = numbers.numberOf(posterior.hypotheses[i]->key);
    if (fresh) groups.push_back({i, weights[i]});
    groups[number].most = std::max(groups[number].most, weights[i]);
    of_slot.push_back(number);
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    Group& group = groups[of_slot[i]];
    group.sum += group.most == kMinusInfinity ? 1 : std::exp(weights[i] - group.most);
  }
  std::vector<double> of_groups;  // log weights
  for (const Group& group : groups) of_groups.push_back(group.most + std::log(group.sum));
  // Ties go to the earlier slot.
  const auto best = std::max_element(of_groups.begin(), of_groups.end());
  MapHypothesis out;
  out.distinct = groups.size();
  if (best == of_groups.end()) return out;
  out.slot = groups[static_cast<std::size_t>(best - of_groups.begin())].first;
  out.probability = std::exp(*best - logSumExp(of_groups));
  return out;
}

}  // namespace perception
