#include "libperception/filter/Step.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "libperception/filter/Parallel.h"

#include "libperception/core/LogMath.h"
#include "libperception/filter/Duplicates.h"
#include "libperception/filter/LikelihoodTable.h"
#include "libperception/filter/Prediction.h"
#include "libperception/filter/Update.h"

namespace perception {
namespace {

enum Purpose : std::uint32_t { kOrder = 0x5701, kSample = 0x5702 };

/// Tracks that hypotheses share, numbered in order of first appearance (so never by address).
struct Distinct {
  std::vector<TrackHandle> tracks;
  std::vector<std::vector<std::size_t>>
      of_hypothesis;  ///< indices into tracks, in the hypothesis's order
};

Distinct distinctTracks(const std::vector<Hypothesis>& hypotheses) {
  Distinct result;
  std::unordered_map<const Track*, std::size_t> number;
  result.of_hypothesis.reserve(hypotheses.size());
  for (const auto& h : hypotheses) {
    auto& indices = result.of_hypothesis.emplace_back();
    indices.reserve(h.tracks.size());
    for (const auto& t : h.tracks) {
      const auto [it, fresh] = number.try_emplace(t.get(), result.tracks.size());
      if (fresh) result.tracks.push_back(t);
      indices.push_back(it->second);
    }
  }
  return result;
}

bool keep(const Track& t, const MeasurementScan& scan, const FilterModel& model) {
  if (t.existence < model.params.existence_min) return false;
  const auto& f = t.bank[static_cast<std::size_t>(t.likeliestClass())];
  const Vector2 ego = scan.state.ego.T_world_ego.translation().head<2>();
  return f.x.allFinite() && f.P.allFinite() &&
         (f.x.head<2>() - ego).norm() <= model.params.max_distance;
}

/// The updated tracks of one scan: made once per distinct (track, cause), handed out as often as
/// needed.
class Updates {
 public:
  Updates(std::size_t tracks, std::size_t measurements)
      : measurements_(measurements),
        wanted_(tracks * (measurements + 1)),
        made_(wanted_.size()),
        new_wanted_(measurements),
        new_made_(measurements) {}

  std::size_t hitCell(std::size_t track, std::size_t k) const {
    return track * (measurements_ + 1) + k;
  }
  std::size_t missCell(std::size_t track) const { return hitCell(track, measurements_); }

  void want(const std::vector<std::size_t>& tracks, const Association& association) {
    for (const std::size_t t : tracks) wanted_[missCell(t)] = 1;
    for (std::size_t k = 0; k < measurements_; ++k) {
      const int cause = association.cause[k];
      if (cause == Association::kNew) {
        new_wanted_[k] = 1;
      } else {
        wanted_[hitCell(tracks[static_cast<std::size_t>(cause)], k)] = 1;
      }
    }
  }

  /// Makes what is wanted; the pairs of a track are found by measurement number.
  std::size_t make(const std::vector<Track>& predicted, const LikelihoodTable& table,
                   const MeasurementScan& scan, std::uint64_t scan_index,
                   const FilterModel& model) {
    parallelFor(predicted.size(), [&](std::size_t t) {
      const auto& row = table.tracks[t];
      for (const auto& pair : row.pairs) {
        if (!wanted_[hitCell(t, pair.measurement)]) continue;
        store(made_[hitCell(t, pair.measurement)],
              hitTrack(predicted[t], row, pair, scan, scan_index, model), scan, model);
      }
      if (wanted_[missCell(t)])
        store(made_[missCell(t)], missTrack(predicted[t], row, scan, model), scan, model);
    });
    parallelFor(measurements_, [&](std::size_t k) {
      if (new_wanted_[k])
        store(new_made_[k], newTrack(table.news[k], k, scan, scan_index, model), scan, model);
    });
    return static_cast<std::size_t>(std::count(wanted_.begin(), wanted_.end(), 1));
  }

  /// Null when the track was dropped.
  const TrackHandle& hit(std::size_t track, std::size_t k) const {
    return made_[hitCell(track, k)];
  }
  const TrackHandle& miss(std::size_t track) const { return made_[missCell(track)]; }
  const TrackHandle& newborn(std::size_t k) const { return new_made_[k]; }

 private:
  static void store(TrackHandle& cell, Track&& track, const MeasurementScan& scan,
                    const FilterModel& model) {
    if (keep(track, scan, model)) cell = std::make_shared<const Track>(std::move(track));
  }

  std::size_t measurements_;
  std::vector<char> wanted_;
  std::vector<TrackHandle> made_;
  std::vector<char> new_wanted_;
  std::vector<TrackHandle> new_made_;
};

Hypothesis assemble(const std::vector<std::size_t>& tracks, const Association& association,
                    const Updates& updates) {
  std::vector<int> measurement_of(tracks.size(), -1);
  for (std::size_t k = 0; k < association.cause.size(); ++k) {
    if (association.cause[k] >= 0)
      measurement_of[static_cast<std::size_t>(association.cause[k])] = static_cast<int>(k);
  }
  Hypothesis h;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const auto& handle = measurement_of[i] < 0
                             ? updates.miss(tracks[i])
                             : updates.hit(tracks[i], static_cast<std::size_t>(measurement_of[i]));
    if (handle) h.tracks.push_back(handle);
  }
  for (std::size_t k = 0; k < association.cause.size(); ++k) {
    if (association.cause[k] == Association::kNew && updates.newborn(k))
      h.tracks.push_back(updates.newborn(k));
  }
  return h;
}

}  // namespace

StepResult step(const std::vector<Hypothesis>& hypotheses, const MeasurementScan& scan,
                const FilterModel& model, const RngKey& key) {
  const Distinct distinct = distinctTracks(hypotheses);
  std::vector<Track> predicted(distinct.tracks.size());
  parallelFor(predicted.size(), [&](std::size_t i) {
    predicted[i] = predictTrack(*distinct.tracks[i], scan.state.stamp, model);
  });

  const LikelihoodTable table = likelihoodTable(predicted, scan, model);

  const AssociationIndex index(predicted, table);
  const auto order = randomOrder(scan.measurements.size(), Rng(key.withPurpose(kOrder)));
  std::vector<Association> associations(hypotheses.size());
  parallelFor(hypotheses.size(), [&](std::size_t i) {
    const Rng rng(key.withPurpose(kSample).withSlot(static_cast<std::uint32_t>(i)));
    associations[i] = associate(distinct.of_hypothesis[i], index, order, rng);
  });

  Updates updates(predicted.size(), scan.measurements.size());
  for (std::size_t i = 0; i < hypotheses.size(); ++i)
    updates.want(distinct.of_hypothesis[i], associations[i]);
  StepResult result;
  result.stats.updates = updates.make(predicted, table, scan, key.counter, model);
  result.hypotheses.resize(hypotheses.size());
  result.log_weights.resize(hypotheses.size());
  parallelFor(hypotheses.size(), [&](std::size_t i) {
    result.hypotheses[i] = assemble(distinct.of_hypothesis[i], associations[i], updates);
    mergeDuplicates(model, scan.state.stamp, result.hypotheses[i]);
    result.log_weights[i] = associations[i].log_weight;
  });
  result.stats.distinct_tracks = predicted.size();
  result.stats.measurements = scan.measurements.size();
  for (const auto& row : table.tracks) result.stats.pairs += row.pairs.size();
  return result;
}

MapHypothesis mapHypothesis(const std::vector<const Hypothesis*>& hypotheses,
                            const std::vector<double>& log_weights) {
  std::map<std::vector<std::uint64_t>, std::pair<std::size_t, double>>
      groups;  // history -> first slot, log weight
  std::vector<std::uint64_t> history;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    history.clear();
    for (const auto& t : hypotheses[i]->tracks) history.push_back(t->history);
    const auto [it, fresh] = groups.try_emplace(history, i, log_weights[i]);
    if (!fresh) it->second.second = logAddExp(it->second.second, log_weights[i]);
  }
  MapHypothesis best;
  best.distinct = groups.size();
  double best_weight = kMinusInfinity;
  for (const auto& [h, group] : groups) {
    // Ties go to the earlier slot, so that the answer does not hang on the hash.
    if (group.second > best_weight || (group.second == best_weight && group.first < best.slot)) {
      best.slot = group.first;
      best_weight = group.second;
    }
  }
  best.probability = std::exp(best_weight - logSumExp(log_weights));
  return best;
}

}  // namespace perception
