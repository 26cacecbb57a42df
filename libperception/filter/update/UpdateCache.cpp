#include "libperception/filter/update/UpdateCache.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/filter/likelihood/AssignmentPrior.h"
#include "libperception/filter/likelihood/Gating.h"
#include "libperception/filter/update/LanePrior.h"
#include "libperception/filter/update/Update.h"

namespace perception {

UpdateCache::UpdateCache(ScanTracks& tracks, const LikelihoodTable& table,
                         const MeasurementScan& scan, const FilterModel& model)
    : tracks_(tracks), table_(table), scan_(scan), model_(model) {
  Cell cell = 0;
  first_.reserve(tracks.before.size() + 1);
  for (const auto& row : table.tracks) {
    first_.push_back(cell);
    cell += 1 + static_cast<Cell>(row.pairs.size());
    measurement_of_.push_back(0);
    for (const auto& pair : row.pairs)
      measurement_of_.push_back(static_cast<std::uint32_t>(pair.measurement));
  }
  of_track_ = first_;
  first_.push_back(cell);
  requested_.assign(cell + table.births.size(), 0);
  computed_.resize(requested_.size());
}

UpdateCache::Cell UpdateCache::hitCell(std::size_t track, std::size_t k) const {
  Cell cell = first_[track] + 1;
  while (measurement_of_[cell] != k) ++cell;
  return cell;
}

void UpdateCache::request(std::size_t h, const Association& association) {
  const auto& own = tracks_.of_hypothesis[h];
  parents_.push_back(tracks_.hypotheses[h]);
  auto& cells = children_.emplace_back();
  cells.reserve(own.size() + association.cause.size());
  for (std::size_t k = 0; k < association.cause.size(); ++k) {
    if (association.cause[k] < 0) continue;
    const auto t = static_cast<std::size_t>(association.cause[k]);
    of_track_[t] = hitCell(t, k);
  }
  for (const std::uint32_t t : own) {
    cells.push_back(of_track_[t]);
    of_track_[t] = missCell(t);
  }
  for (std::size_t k = 0; k < association.cause.size(); ++k)
    if (association.cause[k] == Association::kNew) cells.push_back(newCell(k));
  for (const Cell c : cells) requested_[c] = 1;
}

bool UpdateCache::keep(const Track& t) const {
  if (t.existence < model_.params.existence_min) return false;
  const auto& f = t.bank[static_cast<std::size_t>(t.likeliestClass())];
  const Vector2 ego = scan_.state.ego.T_world_ego.translation().head<2>();
  return f.x.allFinite() && f.P.allFinite() &&
         (f.x.head<2>() - ego).norm() <= model_.params.max_distance;
}

bool UpdateCache::keepDeferred(const Track& t) const {
  const ReachableDisc& w = t.reachable;
  const Vector2 ego = scan_.state.ego.T_world_ego.translation().head<2>();
  const double far = model_.params.max_distance + w.reach + w.speed * (scan_.state.stamp - t.stamp);
  return scan_.state.stamp < w.expires && (w.center - ego).squaredNorm() <= far * far;
}

void UpdateCache::store(Cell cell, Track&& track, const TrackHandle& before) {
  if (model_.history > 0) track.previous = before;
  if (model_.lanes) model_.lanes->apply(model_, track);
  if (!keep(track)) return;
  track.reachable = reachableDiscOf(track, model_);
  computed_[cell] = std::make_shared<const Track>(std::move(track));
}

std::size_t UpdateCache::compute(std::uint64_t scan_index) {
  parallelFor(tracks_.before.size(), [&](std::size_t t) {
    if (!tracks_.touched[t]) {
      if (keepDeferred(*tracks_.before[t])) computed_[missCell(t)] = tracks_.before[t];
      return;
    }
    const auto& row = table_.tracks[t];
    Track& predicted = tracks_.predicted[t];
    Cell last = missCell(t);  // the miss is made after the hits
    if (!requested_[last]) {
      for (Cell cell = first_[t] + 1; cell < first_[t + 1]; ++cell)
        if (requested_[cell]) last = cell;
    }
    for (std::size_t p = 0; p < row.pairs.size(); ++p) {
      const Cell cell = first_[t] + 1 + static_cast<Cell>(p);
      if (!requested_[cell]) continue;
      Track hit = hitTrack(cell == last ? std::move(predicted) : predicted, row, row.pairs[p],
                           scan_, scan_index, model_);
      if (model_.params.region_memory > 0)
        rememberRegion(scan_.measurements[row.pairs[p].measurement], scan_, model_, hit);
      store(cell, std::move(hit), tracks_.before[t]);
    }
    if (requested_[missCell(t)])
      store(missCell(t), missTrack(std::move(predicted), row, scan_, model_), tracks_.before[t]);
  });
  parallelFor(table_.births.size(), [&](std::size_t k) {
    if (requested_[newCell(k)])
      store(newCell(k), newTrack(table_.births[k], k, scan_, scan_index, model_), nullptr);
  });
  duplicates_ = DuplicateTable(model_, scan_.state.stamp, computed_);
  auto all = std::make_shared<TrackTable>(std::move(computed_));
  duplicates_.appendReplacements(*all);
  keys_.reserve(all->size());
  for (const auto& track : *all) keys_.push_back(track ? historyKey(*track) : 0);
  all_ = std::move(all);
  return static_cast<std::size_t>(std::count(requested_.begin(), requested_.end(), 1));
}

std::vector<EndedTrack> UpdateCache::endedOf(std::size_t c) const {
  std::vector<EndedTrack> ended;
  if (model_.history <= 0) return ended;
  const Stamp now = scan_.state.stamp;
  for (const EndedTrack& e : parents_[c]->ended)
    if (now - e.end <= model_.history) ended.push_back(e);
  for (const Cell cell : children_[c]) {
    if ((*all_)[cell] || cell >= first_.back()) continue;
    const auto next = std::upper_bound(first_.begin(), first_.end(), cell);
    ended.push_back({tracks_.before[static_cast<std::size_t>(next - first_.begin()) - 1], now});
  }
  return ended;
}

HypothesisHandle UpdateCache::hypothesis(std::size_t c) {
  std::vector<EndedTrack> ended = endedOf(c);
  std::vector<Cell> cells = duplicates_.merged(std::move(children_[c]));
  std::uint64_t key = 0;
  std::size_t kept = 0;
  for (const Cell cell : cells) {
    if (!(*all_)[cell]) continue;
    key += keys_[cell];
    cells[kept++] = cell;
  }
  cells.resize(kept);
  Hypothesis hypothesis(TrackList(all_, std::move(cells)), key);
  hypothesis.ended = std::move(ended);
  return std::make_shared<const Hypothesis>(std::move(hypothesis));
}

}  // namespace perception
