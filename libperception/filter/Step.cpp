#include "libperception/filter/Step.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "libperception/core/LogMath.h"
#include "libperception/filter/Association.h"
#include "libperception/filter/LikelihoodTable.h"
#include "libperception/filter/Parallel.h"
#include "libperception/filter/Prediction.h"
#include "libperception/filter/Updates.h"

namespace perception {
namespace {

enum Purpose : std::uint32_t { kOrder = 0x5701, kSample = 0x5702 };

/// The hypotheses before the scan, each distinct one once.
struct Groups {
  std::vector<HypothesisHandle> hypotheses;       // in order of first appearance
  std::vector<std::vector<std::uint32_t>> slots;  // that hold it, ascending
};

Groups groupSlots(const Posterior& before) {
  Groups groups;
  std::unordered_map<const Hypothesis*, std::size_t> number;
  for (std::size_t i = 0; i < before.hypotheses.size(); ++i) {
    const auto [it, fresh] =
        number.try_emplace(before.hypotheses[i].get(), groups.hypotheses.size());
    if (fresh) {
      groups.hypotheses.push_back(before.hypotheses[i]);
      groups.slots.emplace_back();
    }
    groups.slots[it->second].push_back(static_cast<std::uint32_t>(i));
  }
  return groups;
}

/// Numbers the tracks in order of first appearance (so never by address) and predicts those that
/// the scan concerns.
ScanTracks tracksOf(const std::vector<HypothesisHandle>& hypotheses, const MeasurementScan& scan,
                    const FilterModel& model) {
  ScanTracks out;
  std::unordered_map<const Track*, std::size_t> number;
  out.of_hypothesis.reserve(hypotheses.size());
  for (const auto& h : hypotheses) {
    auto& indices = out.of_hypothesis.emplace_back();
    indices.reserve(h->tracks.size());
    for (const auto& t : h->tracks) {
      const auto [it, fresh] = number.try_emplace(t.get(), out.before.size());
      if (fresh) out.before.push_back(t);
      indices.push_back(it->second);
    }
  }
  out.touched.assign(out.before.size(), 0);
  parallelFor(out.before.size(),
              [&](std::size_t i) { out.touched[i] = concerns(scan, *out.before[i], model); });
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

std::vector<Child> sampleChildren(const Groups& groups, const ScanTracks& tracks,
                                  const AssociationIndex& index, const RngKey& key) {
  const auto order = randomOrder(index.measurements(), Rng(key.withPurpose(kOrder)));
  std::vector<std::vector<SampledAssociation>> sampled(groups.hypotheses.size());
  parallelFor(sampled.size(), [&](std::size_t h) {
    sampled[h] = sampleAssociations(tracks.of_hypothesis[h], index, order, groups.slots[h],
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
std::vector<Child> rankChildren(const Groups& groups, const std::vector<double>& log_weights,
                                const ScanTracks& tracks, const AssociationIndex& index,
                                const FilterModel& model, std::size_t slots) {
  const bool nearest = model.proposal == Proposal::kNearest;
  const auto k = nearest ? 1 : static_cast<std::size_t>(model.params.ranked_children);
  std::vector<std::vector<Association>> ranked(groups.hypotheses.size());
  parallelFor(ranked.size(), [&](std::size_t h) {
    ranked[h] = rankAssociations(tracks.of_hypothesis[h], index, k, model.params.ranked_span);
  });
  std::vector<Child> children;
  for (std::size_t h = 0; h < ranked.size(); ++h) {
    double weight = kMinusInfinity;
    for (const std::uint32_t s : groups.slots[h]) weight = logAddExp(weight, log_weights[s]);
    for (auto& a : ranked[h]) {
      const double child_weight = weight + a.log_weight;
      children.push_back({h, std::move(a), {}, child_weight});
    }
  }
  std::stable_sort(children.begin(), children.end(),
                   [](const Child& a, const Child& b) { return a.log_weight > b.log_weight; });
  std::size_t kept = 0;
  while (kept < std::min(children.size(), nearest ? 1 : slots) &&
         children[kept].log_weight >= children.front().log_weight - model.params.ranked_span)
    ++kept;
  children.resize(kept);
  return children;
}

/// Children of equal history share a handle (sampled: slots stay) or become one (ranked).
Posterior posteriorOf(std::vector<Child> children, std::vector<HypothesisHandle> handles,
                      const Posterior& before, bool sampled) {
  std::unordered_map<std::uint64_t, std::size_t>
      first;  // by key: the child, or the place in `after`
  Posterior after;
  if (sampled) {
    after.hypotheses.resize(before.hypotheses.size());
    after.log_weights = before.log_weights;
    for (std::size_t c = 0; c < children.size(); ++c) {
      const auto original = first.try_emplace(handles[c]->key, c).first->second;
      for (const std::uint32_t slot : children[c].slots) {
        after.hypotheses[slot] = handles[original];
        after.log_weights[slot] += children[c].association.log_weight;
      }
    }
    return after;
  }
  for (std::size_t c = 0; c < children.size(); ++c) {
    const auto [it, fresh] = first.try_emplace(handles[c]->key, after.hypotheses.size());
    if (fresh) {
      after.hypotheses.push_back(handles[c]);
      after.log_weights.push_back(children[c].log_weight);
    } else {
      double& w = after.log_weights[it->second];
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
  const Groups groups = groupSlots(before);
  const ScanTracks tracks = tracksOf(groups.hypotheses, scan, model);
  const LikelihoodTable table = likelihoodTable(tracks.predicted, tracks.touched, scan, model);
  const AssociationIndex index(tracks.predicted, table, model);
  const bool sampled = model.proposal == Proposal::kSampled;
  std::vector<Child> children =
      sampled ? sampleChildren(groups, tracks, index, key)
              : rankChildren(groups, before.log_weights, tracks, index, model, slots);

  Updates updates(tracks, table, scan, model);
  for (const Child& c : children) updates.want(c.parent, c.association);
  StepResult result;
  result.stats.updates = updates.make(key.counter);
  std::vector<HypothesisHandle> handles(children.size());
  parallelFor(children.size(), [&](std::size_t c) {
    handles[c] = updates.assemble(children[c].parent, children[c].association);
  });
  result.stats.measurements = scan.measurements.size();
  result.stats.distinct_tracks = tracks.before.size();
  for (std::size_t t = 0; t < tracks.before.size(); ++t) {
    result.stats.predicted += tracks.touched[t] != 0;
    result.stats.pairs += table.tracks[t].pairs.size();
  }
  result.posterior = posteriorOf(std::move(children), std::move(handles), before, sampled);
  return result;
}

MapHypothesis mapHypothesis(const Posterior& posterior) {
  struct Group {
    std::size_t first;
    double log_weight;
  };
  std::unordered_map<std::uint64_t, std::size_t> number;  // by key
  std::vector<Group> groups;                              // in order of first appearance
  for (std::size_t i = 0; i < posterior.hypotheses.size(); ++i) {
    const auto [it, fresh] = number.try_emplace(posterior.hypotheses[i]->key, groups.size());
    if (fresh) {
      groups.push_back({i, posterior.log_weights[i]});
    } else {
      double& w = groups[it->second].log_weight;
      w = logAddExp(w, posterior.log_weights[i]);
    }
  }
  // Ties go to the earlier slot.
  const auto best =
      std::max_element(groups.begin(), groups.end(),
                       [](const Group& a, const Group& b) { return a.log_weight < b.log_weight; });
  MapHypothesis out;
  out.distinct = groups.size();
  if (best == groups.end()) return out;
  out.slot = best->first;
  out.probability = std::exp(best->log_weight - logSumExp(posterior.log_weights));
  return out;
}

}  // namespace perception
