#include "libperception/filter/Updates.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "libperception/filter/Parallel.h"
#include "libperception/filter/Update.h"

namespace perception {

Updates::Updates(const ScanTracks& tracks, const LikelihoodTable& table,
                 const MeasurementScan& scan, const FilterModel& model)
    : tracks_(tracks), table_(table), scan_(scan), model_(model) {
  std::size_t cell = 0;
  first_.reserve(tracks.before.size() + 1);
  for (const auto& row : table.tracks) {
    first_.push_back(cell);
    cell += 1 + row.pairs.size();
  }
  first_.push_back(cell);
  wanted_.assign(cell + table.news.size(), 0);
  made_.resize(wanted_.size());
}

std::size_t Updates::hitCell(std::size_t track, std::size_t k) const {
  const auto& pairs = table_.tracks[track].pairs;
  const auto it = std::lower_bound(pairs.begin(), pairs.end(), k,
                                   [](const auto& p, std::size_t m) { return p.measurement < m; });
  return first_[track] + 1 + static_cast<std::size_t>(it - pairs.begin());
}

std::vector<std::size_t> Updates::cellsOf(std::size_t h, const Association& association) const {
  const auto& own = tracks_.of_hypothesis[h];
  std::vector<std::size_t> cells;
  cells.reserve(own.size() + association.cause.size());
  for (const std::size_t t : own) cells.push_back(missCell(t));
  for (std::size_t k = 0; k < association.cause.size(); ++k) {
    const int cause = association.cause[k];
    if (cause >= 0) {
      cells[static_cast<std::size_t>(cause)] = hitCell(own[static_cast<std::size_t>(cause)], k);
    } else if (cause == Association::kNew) {
      cells.push_back(newCell(k));
    }
  }
  return cells;
}

void Updates::want(std::size_t h, const Association& association) {
  for (const std::size_t cell : cellsOf(h, association)) wanted_[cell] = 1;
}

bool Updates::keep(const Track& t) const {
  if (t.existence < model_.params.existence_min) return false;
  const auto& f = t.bank[static_cast<std::size_t>(t.likeliestClass())];
  const Vector2 ego = scan_.state.ego.T_world_ego.translation().head<2>();
  return f.x.allFinite() && f.P.allFinite() &&
         (f.x.head<2>() - ego).norm() <= model_.params.max_distance;
}

void Updates::store(std::size_t cell, Track&& track, const TrackHandle& before) {
  if (model_.history > 0) track.previous = before;
  if (keep(track)) made_[cell] = std::make_shared<const Track>(std::move(track));
}

std::size_t Updates::make(std::uint64_t scan_index) {
  parallelFor(tracks_.before.size(), [&](std::size_t t) {
    if (!tracks_.touched[t]) {
      made_[missCell(t)] = tracks_.before[t];
      return;
    }
    const auto& row = table_.tracks[t];
    const Track& predicted = tracks_.predicted[t];
    for (std::size_t p = 0; p < row.pairs.size(); ++p) {
      const std::size_t cell = first_[t] + 1 + p;
      if (wanted_[cell])
        store(cell, hitTrack(predicted, row, row.pairs[p], scan_, scan_index, model_),
              tracks_.before[t]);
    }
    if (wanted_[missCell(t)])
      store(missCell(t), missTrack(predicted, row, scan_, model_), tracks_.before[t]);
  });
  parallelFor(table_.news.size(), [&](std::size_t k) {
    if (wanted_[newCell(k)])
      store(newCell(k), newTrack(table_.news[k], k, scan_, scan_index, model_), nullptr);
  });
  duplicates_ = DuplicateTable(model_, scan_.state.stamp, made_);
  return static_cast<std::size_t>(std::count(wanted_.begin(), wanted_.end(), 1));
}

HypothesisHandle Updates::assemble(std::size_t h, const Association& association) const {
  const auto cells = duplicates_.merged(cellsOf(h, association));
  std::vector<TrackHandle> handles;
  handles.reserve(cells.size());
  for (const std::size_t cell : cells) {
    const TrackHandle& handle = duplicates_.handle(cell, made_);
    if (handle) handles.push_back(handle);
  }
  return std::make_shared<const Hypothesis>(std::move(handles));
}

}  // namespace perception
