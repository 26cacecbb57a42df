#include "libperception/grid/beams/WindowMarks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

namespace perception {
template <class Mask>
WindowMarks<Mask>::WindowMarks(const GridParams& params, int layers)
    : params_(params),
      cells_(static_cast<int>(std::ceil(params.size / params.resolution))),
      layers_(std::min(layers, kMostLayers)),
      cover_(cells_, layers_),
      fans_(cells_),
      crossed_(columns() + 2 * fans_.margin(), 0),
      hit_(columns(), 0) {}

template <class Mask>
void WindowMarks<Mask>::collect(const GridScan& scan, const CellIndex& first, GridStats& stats) {
  soft_hits_.clear();
  frame_ = WindowFrame(params_, scan.T_world_ground, first, cells_, layers_);
  rays_ = scan.origin.allFinite();
  const Vector3 origin = rays_ ? scan.origin : scan.T_world_ground.translation();
  origin_ = frame_.place(origin);
  cover_.begin(origin_.z);
  fans_.begin(origin_);
  addHits(scan, stats);
  if (rays_) addClear(scan, stats);
  fans_.mark(&crossed_[fans_.margin()]);
  settleSoftHits();
}

template <class Mask>
void WindowMarks<Mask>::addHits(const GridScan& scan, GridStats& stats) {
  const bool weighted = scan.weights.size() == scan.hits.size();
  std::int32_t last = PlacedBlock::kOutside, settled = last;
  for (std::size_t begin = 0; begin < scan.hits.size(); begin += PlacedBlock::kSize) {
    const std::size_t count = std::min(PlacedBlock::kSize, scan.hits.size() - begin);
    frame_.place(scan.hits, begin, count, placed_);
    placed_.chooseHits(count, weighted ? &scan.weights[begin] : nullptr, settled);
    settled = placed_.settled[count - 1];
    stats.hits += placed_.hits;
    for (const std::size_t k : placed_.chosen) {
      const std::int32_t cell = placed_.cell[k];
      bool wanted = cell != PlacedBlock::kNotFinite;
      if (cell >= 0) {
        if (placed_.in_slab[k] != 0)
          wanted = addHit(cell, weighted ? scan.weights[begin + k] : 1.0F);
        wanted = wanted && cell != last;
        last = cell;
      }
      if (wanted) addBeam(k);
    }
    finishBlock(stats);
  }
}

// Returns whether its beam is needed.
template <class Mask>
bool WindowMarks<Mask>::addHit(std::int32_t cell, float weight) {
  const auto column = static_cast<std::uint32_t>(cell / PlacedBlock::kLayers);
  const auto layer = static_cast<std::uint8_t>(cell % PlacedBlock::kLayers);
  if (weight >= PlacedBlock::kFullWeight || !std::isfinite(weight)) {  // not finite: full weight
    const Mask bit = Mask{1} << layer;
    const bool first = !(hit_[column] & bit);
    hit_[column] |= bit;
    return first;
  }
  if (weight > 0) soft_hits_.push_back({column, layer, false, weight});
  return true;
}

template <class Mask>
void WindowMarks<Mask>::addClear(const GridScan& scan, GridStats& stats) {
  std::int32_t settled = PlacedBlock::kOutside;
  for (std::size_t begin = 0; begin < scan.clear.size(); begin += PlacedBlock::kSize) {
    const std::size_t count = std::min(PlacedBlock::kSize, scan.clear.size() - begin);
    frame_.place(scan.clear, begin, count, placed_);
    placed_.chooseClear(count, settled);
    settled = placed_.settled[count - 1];
    for (const std::size_t k : placed_.chosen)
      if (placed_.cell[k] != PlacedBlock::kNotFinite) addBeam(k);
    finishBlock(stats);
  }
}

template <class Mask>
void WindowMarks<Mask>::finishBlock(GridStats& stats) {
  stats.not_finite += placed_.not_finite;
  stats.rays += beams_.count;
  castBeams();
}

template <class Mask>
void WindowMarks<Mask>::castBeams() {
  beams_.prepare(origin_, cells_, layers_, fans_.bins());
  for (std::size_t i = 0; i < beams_.count; ++i) {
    const float to = beams_.to[i];
    if (!(beams_.from[i] < to)) continue;
    const float from =
        cover_.take(beams_.face[i], beams_.bin_across[i], beams_.bin_up[i], beams_.from[i], to);
    if (!(from < to)) continue;
    if (fans_.isFull()) fans_.mark(&crossed_[fans_.margin()]);
    fans_.add(beams_.fan[i], {std::abs(beams_.across[i]), beams_.up[i], from, to});
  }
  beams_.count = 0;
}

namespace {

/// By column and layer, the largest weight first. As integers, weights from 0 to 1 are in their
/// order.
template <class SoftHit>
std::uint64_t orderOf(const SoftHit& hit) {
  std::uint32_t weight;
  std::memcpy(&weight, &hit.weight, sizeof weight);
  return std::uint64_t{hit.column} << 38 | std::uint64_t{hit.layer} << 32 | ~weight;
}

/// Sorts by orderOf(): many by their columns first, which are `columns`.
template <class SoftHit>
void sortByOrder(std::vector<SoftHit>& hits, std::size_t columns) {
  const auto less = [](const SoftHit& a, const SoftHit& b) { return orderOf(a) < orderOf(b); };
  if (hits.size() < columns / 32) {  // cheaper than a pass over the columns (assumed)
    std::sort(hits.begin(), hits.end(), less);
    return;
  }
  thread_local std::vector<std::uint32_t> end;  // of each column
  end.assign(columns + 1, 0);
  for (const SoftHit& hit : hits) ++end[hit.column + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<SoftHit> sorted(hits.size());
  for (const SoftHit& hit : hits) sorted[end[hit.column]++] = hit;
  for (auto from = sorted.begin(); from != sorted.end();) {
    const auto to = sorted.begin() + end[from->column];
    std::sort(from, to, less);
    from = to;
  }
  hits.swap(sorted);
}

}  // namespace

// One entry per cell, without cells that have a hit of full weight.
template <class Mask>
void WindowMarks<Mask>::settleSoftHits() {
  sortByOrder(soft_hits_, columns());
  std::size_t kept = 0;
  for (const SoftHit& doubt : soft_hits_) {
    if (hit_[doubt.column] >> doubt.layer & 1) continue;
    if (kept > 0 && soft_hits_[kept - 1].column == doubt.column &&
        soft_hits_[kept - 1].layer == doubt.layer)
      continue;
    const Mask bit = Mask{1} << doubt.layer;
    soft_hits_[kept] = doubt;
    Mask& crossed = crossed_[fans_.margin() + doubt.column];
    soft_hits_[kept++].crossed = (crossed & bit) != 0;
    crossed &= ~bit;
  }
  soft_hits_.resize(kept);
}

template <class Mask>
std::size_t WindowMarks<Mask>::memoryBytes() const {
  return (crossed_.capacity() + hit_.capacity()) * sizeof(Mask) +
         soft_hits_.capacity() * sizeof(SoftHit) + cover_.memoryBytes() + fans_.memoryBytes() +
         sizeof *this;
}

template class WindowMarks<std::uint32_t>;
template class WindowMarks<std::uint64_t>;

}  // namespace perception
