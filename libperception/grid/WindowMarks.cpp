#include "libperception/grid/WindowMarks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {
namespace {

// After so many columns in a row that were crossed before, the rest was, too: a least number and a
// share of the columns left, over which rays that came together may part again.
constexpr int kAgreed = 2;
constexpr float kAgreedShare = 0.1F;
constexpr float kFullWeight = 0.99F;  // counts as 1
constexpr float kInside = 1e-3F;      // [cells] by which clipped ends stay within the window

// Shrinks [from, to] to where a linear function that is `a` at 0 and `b` at 1 is not negative.
inline void clip(float a, float b, float& from, float& to) {
  if (a >= 0 && b >= 0) return;
  if (a < 0 && b < 0) {
    to = -1;
    return;
  }
  const float zero = a / (a - b);
  if (a < 0) {
    from = std::max(from, zero);
  } else {
    to = std::min(to, zero);
  }
}

}  // namespace

template <class Mask>
WindowMarks<Mask>::WindowMarks(const GridParams& params, int layers)
    : params_(params),
      cells_(static_cast<int>(std::ceil(params.size / params.resolution))),
      layers_(std::min(layers, kMostLayers)),
      per_metre_(1 / params.resolution),
      crossed_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), 0),
      hit_(crossed_.size(), 0) {}

template <class Mask>
typename WindowMarks<Mask>::Place WindowMarks<Mask>::placeOf(const Vector3& p) const {
  const double above = slope_x_ * p.x() + slope_y_ * p.y() + slope_z_ * p.z() + offset_;
  double wider = 0;
  if (params_.grade > 0) {
    const double dx = p.x() - centre_.x(), dy = p.y() - centre_.y();
    wider = params_.grade * std::sqrt(dx * dx + dy * dy);
  }
  return {static_cast<float>((p.x() - corner_.x()) * per_metre_),
          static_cast<float>((p.y() - corner_.y()) * per_metre_),
          static_cast<float>((p.z() - corner_.z()) * per_metre_),
          static_cast<float>(above - params_.z_min + wider),
          static_cast<float>(params_.z_max + wider - above)};
}

template <class Mask>
bool WindowMarks<Mask>::inWindow(const Place& p) const {
  const auto n = static_cast<float>(cells_), l = static_cast<float>(layers_);
  return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < n && p.y < n && p.z < l;
}

template <class Mask>
void WindowMarks<Mask>::collect(const GridScan& scan, const CellIndex& first, GridStats& stats) {
  doubts_.clear();
  corner_ = params_.resolution * Vector3(static_cast<double>(first.x), static_cast<double>(first.y),
                                         static_cast<double>(first.z));
  centre_ = scan.T_world_ground.translation().head<2>();
  const Vector3 up = scan.T_world_ground.linear().col(2);
  slope_x_ = up.x(), slope_y_ = up.y(), slope_z_ = up.z();
  offset_ = -up.dot(scan.T_world_ground.translation());
  const bool rays = scan.origin.allFinite();
  origin_ = placeOf(rays ? scan.origin : scan.T_world_ground.translation());
  takeHits(scan, stats);
  if (!rays) return;
  takeClear(scan, stats);
}

template <class Mask>
void WindowMarks<Mask>::takeHits(const GridScan& scan, GridStats& stats) {
  const bool weighted = scan.weights.size() == scan.hits.size();
  const bool rays = scan.origin.allFinite();
  int last_x = -1, last_y = -1, last_z = -1;
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    const Place p = placeOf(scan.hits[i]);
    if (inWindow(p)) {
      const int x = static_cast<int>(p.x), y = static_cast<int>(p.y), z = static_cast<int>(p.z);
      const bool repeated = x == last_x && y == last_y && z == last_z;
      last_x = x, last_y = y, last_z = z;
      if (p.low >= 0 && p.high >= 0) {
        ++stats.hits;
        const auto column = static_cast<std::uint32_t>(y * cells_ + x);
        const float w = weighted ? scan.weights[i] : 1.0F;
        if (w >= kFullWeight || !std::isfinite(w)) {  // no verdict: believe the return
          const Mask bit = Mask{1} << z;
          if (hit_[column] & bit) continue;
          hit_[column] |= bit;
        } else if (w > 0) {
          doubts_.push_back({column, static_cast<std::uint8_t>(z), w});
        }
      }
      if (repeated) continue;
    } else if (!scan.hits[i].allFinite()) {
      ++stats.not_finite;
      continue;
    }
    if (!rays) continue;
    ++stats.rays;
    cast(p);
  }
  mergeDoubts();
}

template <class Mask>
void WindowMarks<Mask>::takeClear(const GridScan& scan, GridStats& stats) {
  int last_x = -1, last_y = -1, last_z = -1;
  for (const Vector3& point : scan.clear) {
    const Place p = placeOf(point);
    if (inWindow(p)) {
      const int x = static_cast<int>(p.x), y = static_cast<int>(p.y), z = static_cast<int>(p.z);
      if (x == last_x && y == last_y && z == last_z) continue;
      last_x = x, last_y = y, last_z = z;
    } else if (!point.allFinite()) {
      ++stats.not_finite;
      continue;
    }
    ++stats.rays;
    cast(p);
  }
}

// Backwards from the end, after Amanatides and Woo, "A fast voxel traversal algorithm"
// (Eurographics 1987), in two dimensions; a column takes the layers between where the ray enters
// and leaves it. The cell of the end itself is not crossed: that is where the beam ended.
template <class Mask>
void WindowMarks<Mask>::cast(const Place& end) {
  const Place& o = origin_;
  const auto n = static_cast<float>(cells_), l = static_cast<float>(layers_);
  float from = 0, to = 1;
  clip(o.low, end.low, from, to), clip(o.high, end.high, from, to);
  clip(o.x - kInside, end.x - kInside, from, to);
  clip(o.y - kInside, end.y - kInside, from, to);
  clip(o.z - kInside, end.z - kInside, from, to);
  clip(n - kInside - o.x, n - kInside - end.x, from, to);
  clip(n - kInside - o.y, n - kInside - end.y, from, to);
  clip(l - kInside - o.z, l - kInside - end.z, from, to);
  if (!(from < to)) return;
  const float dx = o.x - end.x, dy = o.y - end.y, dz = o.z - end.z;
  float s = 1 - to;  // share of the way back to the sensor
  const float last = 1 - from;
  int x = static_cast<int>(end.x + s * dx), y = static_cast<int>(end.y + s * dy);
  constexpr float kNever = std::numeric_limits<float>::infinity();
  const float per_x = dx != 0 ? std::abs(1 / dx) : kNever;  // of s per column
  const float per_y = dy != 0 ? std::abs(1 / dy) : kNever;
  const int step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? cells_ : -cells_;
  float next_x = dx != 0 ? (static_cast<float>(dx > 0 ? x + 1 : x) - end.x) / dx : kNever;
  float next_y = dy != 0 ? (static_cast<float>(dy > 0 ? y + 1 : y) - end.y) / dy : kNever;
  int z = static_cast<int>(end.z + s * dz);
  auto column = static_cast<std::ptrdiff_t>(y * cells_ + x);
  Mask spared = s > 0 ? 0 : Mask{1} << z;
  int agreed = 0;
  const int enough =
      kAgreed + static_cast<int>(kAgreedShare * (last - s) * (std::abs(dx) + std::abs(dy)));
  while (true) {
    const bool sideways = next_x < next_y;
    const float next = sideways ? next_x : next_y;
    const bool done = !(next < last);
    const int left = static_cast<int>(end.z + (done ? last : next) * dz);
    const int low = z < left ? z : left, high = z < left ? left : z;
    const Mask layers = static_cast<Mask>(((Mask{2} << high) - (Mask{1} << low)) & ~spared);
    Mask& marked = crossed_[static_cast<std::size_t>(column)];
    agreed = (marked & layers) == layers ? agreed + (spared == 0) : 0;
    marked |= layers;
    if (done || agreed >= enough) return;
    spared = 0, z = left;
    column += sideways ? step_x : step_y;
    next_x += sideways ? per_x : 0, next_y += sideways ? 0 : per_y;
  }
}

// One entry a cell, without those that a trusted return has settled.
template <class Mask>
void WindowMarks<Mask>::mergeDoubts() {
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
    doubts_[kept++] = doubt;
  }
  doubts_.resize(kept);
}

template <class Mask>
std::size_t WindowMarks<Mask>::memoryBytes() const {
  return (crossed_.capacity() + hit_.capacity()) * sizeof(Mask) +
         doubts_.capacity() * sizeof(Doubt);
}

template class WindowMarks<std::uint32_t>;
template class WindowMarks<std::uint64_t>;

}  // namespace perception
