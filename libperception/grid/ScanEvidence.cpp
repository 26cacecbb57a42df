#include "libperception/grid/ScanEvidence.h"

#include <algorithm>
#include <limits>

namespace perception {
namespace {

constexpr std::uint8_t kCrossed = 0x80;
constexpr double kFullWeight = 127;
// Least weight of a hit that ends a 2D ray; behind a probable phantom the beam was free.
constexpr float kTrusted = 0.5F;
// Elevations are binned by their tangent up to this one (45 deg): steeper beams leave the slab
// immediately.
constexpr double kSteepest = 1;

float weightOf(const GridScan& scan, std::size_t i) {
  if (scan.weights.size() != scan.hits.size()) return 1;
  const float w = scan.weights[i];
  return std::isfinite(w) ? std::clamp(w, 0.0F, 1.0F) : 1.0F;  // not finite: full weight
}

Vector3 pointOf(const GridScan& scan, std::size_t i) {
  return i < scan.hits.size() ? scan.hits[i] : scan.clear[i - scan.hits.size()];
}

}  // namespace

ScanEvidence::ScanEvidence(const GridParams& params, bool flat)
    : params_(params),
      flat_(flat),
      cells_(static_cast<std::int64_t>(std::ceil(params.size / params.resolution))),
      bearings_(static_cast<std::size_t>(std::ceil(kTwoPi / params.ray_step))),
      elevations_(flat ? 1
                       : static_cast<std::size_t>(std::ceil(2 * kSteepest / params.ray_step)) + 1) {
}

const std::vector<CellEvidence>& ScanEvidence::collect(const GridScan& scan, GridStats& stats) {
  evidence_.clear();
  placeWindow(scan);
  markHits(scan, stats);
  chooseRays(scan, stats);
  evidence_.reserve(touched_.size());
  const bool judged = !scan.hits.empty() && scan.weights.size() == scan.hits.size();
  for (const std::uint32_t place : touched_) {
    const std::uint8_t mark = marks_[place];
    evidence_.push_back(
        {cellAt(place), (mark & ~kCrossed) / kFullWeight, (mark & kCrossed) != 0, true, judged});
    marks_[place] = 0;
  }
  touched_.clear();
  return evidence_;
}

// Height range of the window in the world: the slab over the whole window, tilted and widened.
void ScanEvidence::placeWindow(const GridScan& scan) {
  const Vector3 center = scan.T_world_ground.translation();
  T_ground_world_ = scan.T_world_ground.inverse();
  first_ = {indexOf(center.x()) - cells_ / 2, indexOf(center.y()) - cells_ / 2, 0};
  layers_ = 1;
  if (!flat_) {
    const Vector3 up = scan.T_world_ground.linear().col(2);
    const double tilt = std::hypot(up.x(), up.y()) / std::max(0.5, up.z());  // at most 60 deg
    const double spread = (tilt + params_.grade) * params_.size * std::sqrt(0.5);
    first_.z = indexOf(center.z() + params_.z_min - spread);
    layers_ = indexOf(center.z() + params_.z_max + spread) - first_.z + 1;
  }
  marks_.resize(static_cast<std::size_t>(cells_ * cells_ * layers_), 0);
}

bool ScanEvidence::isRelevant(const CellIndex& cell) const {
  const double z = T_ground_world_.linear().row(2).dot(
                       Vector3(centerOf(cell.x), centerOf(cell.y), centerOf(cell.z))) +
                   T_ground_world_.translation().z();
  return z >= params_.z_min && z <= params_.z_max;
}

// `p`: ground frame.
bool ScanEvidence::inSlab(const Vector3& p) const {
  const double outside = std::max(params_.z_min - p.z(), p.z() - params_.z_max);
  return outside <= 0 ||
         outside * outside <= params_.grade * params_.grade * p.head<2>().squaredNorm();
}

void ScanEvidence::touch(std::size_t cell, std::uint8_t mark) {
  std::uint8_t& old = marks_[cell];
  if (old == 0) touched_.push_back(static_cast<std::uint32_t>(cell));
  const auto weight = static_cast<std::uint8_t>(std::max(old & ~kCrossed, mark & ~kCrossed));
  old = static_cast<std::uint8_t>(((old | mark) & kCrossed) | weight);
}

CellIndex ScanEvidence::cellAt(std::size_t cell) const {
  const auto place = static_cast<std::int64_t>(cell);
  return {first_.x + place % cells_, first_.y + place / cells_ % cells_,
          first_.z + place / (cells_ * cells_)};
}

void ScanEvidence::markHits(const GridScan& scan, GridStats& stats) {
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    const Vector3 p = scan.hits[i];
    if (!p.allFinite()) {
      ++stats.not_finite;
      continue;
    }
    const std::int64_t x = indexOf(p.x()) - first_.x, y = indexOf(p.y()) - first_.y;
    const std::int64_t z = flat_ ? 0 : indexOf(p.z()) - first_.z;
    if (x < 0 || y < 0 || z < 0 || x >= cells_ || y >= cells_ || z >= layers_) continue;
    if (!inSlab(T_ground_world_ * p)) continue;
    ++stats.hits;
    const auto weight = static_cast<std::uint8_t>(std::lround(weightOf(scan, i) * kFullWeight));
    if (weight > 0) touch(static_cast<std::size_t>((z * cells_ + y) * cells_ + x), weight);
  }
}

// 3D: the nearest return of a direction, so that no ray passes an obstacle. 2D: the first trusted
// hit of a bearing or, without one, the farthest return.
void ScanEvidence::offerRay(const GridScan& scan, std::size_t point, bool stops) {
  const Vector3 d = pointOf(scan, point) - scan.origin;
  const double flat_range = d.head<2>().norm();
  if (!(flat_range > params_.resolution)) return;
  const double turn = (std::atan2(d.y(), d.x()) + kPi) / kTwoPi;
  const std::size_t bearing =
      std::min(static_cast<std::size_t>(turn * static_cast<double>(bearings_)), bearings_ - 1);
  std::size_t elevation = 0;
  if (!flat_) {
    const double tangent = d.z() / flat_range;
    if (std::abs(tangent) >= kSteepest) return;
    elevation = static_cast<std::size_t>((tangent + kSteepest) / params_.ray_step);
  }
  Ray& ray = rays_[bearing * elevations_ + elevation];
  const auto r = static_cast<float>(d.norm());
  const bool better =
      ray.range <= 0 ||
      (flat_ ? (ray.stopped ? stops && r < ray.range : stops || r > ray.range) : r < ray.range);
  if (better) ray = {r, static_cast<std::uint32_t>(point), stops};
}

void ScanEvidence::chooseRays(const GridScan& scan, GridStats& stats) {
  rays_.assign(bearings_ * elevations_, Ray{});
  if (!scan.origin.allFinite()) return;
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    if (!scan.hits[i].allFinite()) continue;
    offerRay(scan, i, weightOf(scan, i) >= kTrusted && inSlab(T_ground_world_ * scan.hits[i]));
  }
  for (std::size_t i = 0; i < scan.clear.size(); ++i) {
    if (scan.clear[i].allFinite()) {
      offerRay(scan, scan.hits.size() + i, false);
    } else {
      ++stats.not_finite;
    }
  }
  for (const Ray& ray : rays_) {
    if (ray.range <= 0) continue;
    ++stats.rays;
    castRay(scan.origin, pointOf(scan, ray.point));
  }
}

// Amanatides and Woo, "A fast voxel traversal algorithm" (Eurographics 1987). The end cell is not
// crossed.
void ScanEvidence::castRay(const Vector3& origin, const Vector3& end) {
  const double range = (end - origin).norm();
  const Vector3 direction = (end - origin) / range;
  const Vector3 low_origin = T_ground_world_ * origin;  // in the ground frame
  const Vector3 low_direction = T_ground_world_.linear() * direction;
  const double res = params_.resolution;
  const int axes = flat_ ? 2 : 3;
  std::int64_t at[3] = {indexOf(origin.x()) - first_.x, indexOf(origin.y()) - first_.y,
                        flat_ ? 0 : indexOf(origin.z()) - first_.z};
  const std::int64_t first[3] = {first_.x, first_.y, first_.z};
  const std::int64_t count[3] = {cells_, cells_, layers_};
  std::int64_t step[3] = {0, 0, 0};
  double next[3], delta[3];  // [m] along the ray: to the next border, from border to border
  for (int a = 0; a < 3; ++a) {
    const double d = a < axes ? direction[a] : 0;
    step[a] = d > 0 ? 1 : d < 0 ? -1 : 0;
    delta[a] = step[a] ? res / std::abs(d) : std::numeric_limits<double>::infinity();
    const double border = static_cast<double>(at[a] + first[a] + (d > 0 ? 1 : 0)) * res;
    next[a] = step[a] ? (border - origin[a]) / d : std::numeric_limits<double>::infinity();
  }
  double t = 0;
  while (true) {
    const int a = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    if (next[a] >= range) return;  // the end is in this cell
    bool inside = true;
    for (int b = 0; b < 3; ++b) {
      // A ray may enter the layers of the window from above (lidar on a high roof).
      if (at[b] < 0 && step[b] <= 0) return;
      if (at[b] >= count[b] && step[b] >= 0) return;
      inside = inside && at[b] >= 0 && at[b] < count[b];
    }
    if (inside && inSlab(low_origin + (t + next[a]) / 2 * low_direction)) {
      touch(static_cast<std::size_t>((at[2] * cells_ + at[1]) * cells_ + at[0]), kCrossed);
    }
    t = next[a];
    at[a] += step[a];
    next[a] += delta[a];
  }
}

std::size_t ScanEvidence::memoryBytes() const {
  return marks_.capacity() + touched_.capacity() * sizeof(std::uint32_t) +
         rays_.capacity() * sizeof(Ray) + evidence_.capacity() * sizeof(CellEvidence);
}

}  // namespace perception
