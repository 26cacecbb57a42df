#include "libperception/grid/WindowMarks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {
namespace {

constexpr float kFullWeight = 0.99F;  // counts as 1

}  // namespace

template <class Mask>
WindowMarks<Mask>::WindowMarks(const GridParams& params, int layers)
    : params_(params),
      cells_(static_cast<int>(std::ceil(params.size / params.resolution))),
      layers_(std::min(layers, kMostLayers)),
      cover_(cells_, layers_),
      fans_(cells_),
      crossed_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), 0),
      hit_(crossed_.size(), 0) {}

template <class Mask>
void WindowMarks<Mask>::collect(const GridScan& scan, const CellIndex& first, GridStats& stats) {
  doubts_.clear();
  frame_ = WindowFrame(params_, scan.T_world_ground, first, cells_, layers_);
  rays_ = scan.origin.allFinite();
  const Vector3 origin = rays_ ? scan.origin : scan.T_world_ground.translation();
  frame_.place(&origin, 1, placed_);
  origin_ = placed_.at(0);
  cover_.begin(origin_.z);
  fans_.begin(origin_);
  takeHits(scan, stats);
  if (rays_) forPoints(scan.clear, stats, [](std::size_t, std::int32_t, bool) { return true; });
  fans_.mark(crossed_.data());
  settleDoubts();
}

template <class Mask>
template <class Take>
void WindowMarks<Mask>::forPoints(const std::vector<Vector3>& points, GridStats& stats,
                                  const Take& take) {
  std::int32_t last = -1;
  for (std::size_t begin = 0; begin < points.size(); begin += PlacedBlock::kSize) {
    const std::size_t count = std::min(PlacedBlock::kSize, points.size() - begin);
    frame_.place(&points[begin], count, placed_);
    for (std::size_t k = 0; k < count; ++k) {
      const std::int32_t cell = placed_.cell[k];
      if (cell >= 0) {
        const bool wanted = take(begin + k, cell, placed_.in_slab[k] != 0);
        const bool repeated = cell == last;
        last = cell;
        if (!wanted || repeated) continue;
      } else if (cell == PlacedBlock::kNotFinite) {
        ++stats.not_finite;
        continue;
      }
      if (!rays_) continue;
      ++stats.rays;
      beams_.add(placed_.at(k));
      if (beams_.count == BeamBlock::kSize) castBeams();
    }
  }
  castBeams();
}

template <class Mask>
void WindowMarks<Mask>::takeHits(const GridScan& scan, GridStats& stats) {
  const bool weighted = scan.weights.size() == scan.hits.size();
  forPoints(scan.hits, stats, [&](std::size_t i, std::int32_t cell, bool in_slab) {
    if (!in_slab) return true;
    ++stats.hits;
    const auto column = static_cast<std::uint32_t>(cell / PlacedBlock::kLayers);
    const auto layer = static_cast<std::uint8_t>(cell % PlacedBlock::kLayers);
    const float w = weighted ? scan.weights[i] : 1.0F;
    if (w >= kFullWeight || !std::isfinite(w)) {  // no verdict: believe the return
      const Mask bit = Mask{1} << layer;
      const bool first = !(hit_[column] & bit);
      hit_[column] |= bit;
      return first;
    }
    if (w > 0) doubts_.push_back({column, layer, false, w});
    return true;
  });
}

template <class Mask>
void WindowMarks<Mask>::castBeams() {
  beams_.prepare(origin_, cells_, layers_);
  for (std::size_t i = 0; i < beams_.count; ++i) {
    const float to = beams_.to[i];
    if (!(beams_.from[i] < to)) continue;
    const float from =
        cover_.take(beams_.face[i], beams_.bin_across[i], beams_.bin_up[i], beams_.from[i], to);
    if (from < to) cross(i, from, to);
  }
  beams_.count = 0;
}

template <class Mask>
void WindowMarks<Mask>::cross(std::size_t i, float from, float to) {
  const bool along_x = beams_.face[i] < 2, back = beams_.face[i] % 2 != 0;
  const float on = along_x ? origin_.x : origin_.y, aside = along_x ? origin_.y : origin_.x;
  const float across = beams_.across[i], up = beams_.up[i];
  // What lies between two places within the window lies within it, whatever the rounding.
  const auto isInside = [&](float t) {
    const float x = back ? on - t : on + t, y = aside + across * t, z = origin_.z + up * t;
    return x >= 0 && x < static_cast<float>(cells_) && y >= 0 && y < static_cast<float>(cells_) &&
           z >= 0 && z < static_cast<float>(layers_);
  };
  if (!isInside(from) || !isInside(to)) return;
  if (fans_.isFull()) fans_.mark(crossed_.data());
  fans_.add(beams_.face[i], {across, up, from, to});
}

// One entry a cell, without those that a trusted return has settled.
template <class Mask>
void WindowMarks<Mask>::settleDoubts() {
  std::sort(doubts_.begin(), doubts_.end(), [](const Doubt& a, const Doubt& b) {
    if (a.column != b.column) return a.column < b.column;
    return a.layer != b.layer ? a.layer < b.layer : a.weight > b.weight;
  });
  std::size_t kept = 0;
  for (const Doubt& doubt : doubts_) {
    if (hit_[doubt.column] >> doubt.layer & 1) continue;
    if (kept > 0 && doubts_[kept - 1].column == doubt.column &&
        doubts_[kept - 1].layer == doubt.layer)
      continue;
    const Mask bit = Mask{1} << doubt.layer;
    doubts_[kept] = doubt;
    doubts_[kept++].crossed = (crossed_[doubt.column] & bit) != 0;
    crossed_[doubt.column] &= ~bit;
  }
  doubts_.resize(kept);
}

template <class Mask>
std::size_t WindowMarks<Mask>::memoryBytes() const {
  return (crossed_.capacity() + hit_.capacity()) * sizeof(Mask) +
         doubts_.capacity() * sizeof(Doubt) + cover_.memoryBytes() + fans_.memoryBytes() +
         sizeof *this;
}

template class WindowMarks<std::uint32_t>;
template class WindowMarks<std::uint64_t>;

}  // namespace perception
