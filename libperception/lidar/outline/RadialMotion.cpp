#include "libperception/lidar/outline/RadialMotion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {
namespace {

constexpr std::size_t kAzimuthBins = 1440;  // of azimuth, 0.25 deg
constexpr float kFarthestMoving = 80;      // [m] from the sensor
constexpr std::size_t kFewestMoving = 20;  // returns of a cluster
constexpr double kMostTime = 0.25;    // [s] between two scans

// Cells of direction, as wide and high as the surface of an object is smooth (assumed).
constexpr double kCellWidth = 0.15, kCellHeight = 0.2;  // [m]
constexpr int kFlowRows = 16, kFlowColumns = 64;
constexpr std::size_t kMostInCell = 6;  // returns of each scan

constexpr double kLeastMoving = 3;       // [m/s]: what is slower starts well as it is
constexpr double kFastest = 45;          // [m/s] of a road user
constexpr double kWayStep = 0.1;            // [m] of the histogram of ways
constexpr double kWaySigma = 0.1;        // [m] of a way, with the poses' errors (assumed)
/// Of the time between two looks, which is not quite that between the stamps (assumed).
constexpr double kTimeError = 0.1;
constexpr double kLeastShare = 0.15;     // of the directions that agree
constexpr double kLeastDirections = 8;   // that agree
constexpr double kClearly = 1.5;         // times as many as of any other way
constexpr double kSteepest = 0.5;        // [-] of the surface against the line of sight

// What hangs before a surface that moved, as spray before the rear of a car (assumed).
constexpr double kSurfaceDepth = 0.4, kBeforeLayer = 0.2;  // [m] depth of the surface, and before it
constexpr double kLeastOfCloud = 0.1;               // of the cluster's returns
constexpr std::size_t kCloudToOwn = 2;              // times as many as of its own
constexpr double kOutermost = 0.03, kBeyond = 0.1;  // share of the surface's returns; [m]

std::size_t azimuthBinOf(float x, float y) {
  const auto turn = fastAtan2(x, y) * static_cast<float>(1 / kTwoPi) + 1;
  return static_cast<std::size_t>(turn * static_cast<float>(kAzimuthBins)) % kAzimuthBins;
}

/// Sums for a line through the returns that moved alike.
struct LineOfRanges {
  double n = 0, y = 0, r = 0, yy = 0, yr = 0;
  void add(double across, double range) {
    ++n, y += across, r += range, yy += across * across, yr += across * range;
  }
  /// dr / dy, 0 of what is too narrow to tell.
  double slope() const {
    const double spread = yy - y * y / n;
    return spread < n * 0.1 * 0.1 ? 0 : (yr - y * r / n) / spread;
  }
};

/// A return of a cluster.
struct Place {
  double across = 0, range = 0;          ///< [m] to the left of its middle, from the sensor
  bool judged = false, agrees = false;   ///< seen in the scan before, by the same way
};

/// The returns of the surface that moved and of what lies behind it, if a cloud that did not hangs
/// before it; empty: none does.
std::vector<std::uint32_t> behindCloud(const std::vector<Place>& places, double slope,
                                       const std::vector<std::uint32_t>& points) {
  std::vector<double> depths, across;
  for (const Place& p : places)
    if (p.agrees) depths.push_back(p.range - slope * p.across);
  std::sort(depths.begin(), depths.end());
  // The layer that holds most of them.
  std::size_t best = 0, most = 0;
  for (std::size_t i = 0, end = 0; i < depths.size(); ++i) {
    while (end < depths.size() && depths[end] - depths[i] <= kSurfaceDepth) ++end;
    if (end - i > most) most = end - i, best = i;
  }
  if (most == 0) return {};
  const double nearest = depths[best], farthest = nearest + kSurfaceDepth;
  std::size_t strange = 0, own = 0;
  for (const Place& p : places) {
    const double depth = p.range - slope * p.across;
    if (p.agrees && depth >= nearest && depth <= farthest) across.push_back(p.across);
    if (p.judged && depth < nearest - kBeforeLayer) ++(p.agrees ? own : strange);
  }
  if (strange < kLeastOfCloud * places.size() || strange < own * kCloudToOwn) return {};
  std::sort(across.begin(), across.end());
  const auto quantile = [&](double q) {
    return across[static_cast<std::size_t>(q * static_cast<double>(across.size() - 1))];
  };
  const double right = quantile(kOutermost) - kBeyond, left = quantile(1 - kOutermost) + kBeyond;
  std::vector<std::uint32_t> kept;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Place& p = places[k];
    if (p.range - slope * p.across >= nearest - kBeforeLayer && p.across >= right &&
        p.across <= left)
      kept.push_back(points[k]);
  }
  return kept;
}

}  // namespace

RadialMotion::RadialMotion(const EarlierScan& before, const LidarDetections& now,
                           const EgoState& ego, Stamp stamp)
    : now_(now), ego_(ego), dt_(stamp - before.stamp), at_(kAzimuthBins + 1, 0) {
  if (!(dt_ > 0) || dt_ > kMostTime) return;
  const Eigen::Isometry3f T = (ego.T_world_ego.inverse() * before.T_world_ego).cast<float>();
  const PlacedReturns& r = *before.returns;
  const auto lowest = static_cast<float>(r.height_min), highest = static_cast<float>(r.height_max);
  const Eigen::Vector3f sensor = now.points.sensor.cast<float>();
  std::vector<Return> placed;
  std::vector<std::uint16_t> bins;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r.height[i] < lowest || r.height[i] > highest) continue;
    const Eigen::Vector3f p = T * Eigen::Vector3f(r.x[i], r.y[i], r.z[i]) - sensor;
    const float range = std::hypot(p.x(), p.y());
    if (range > kFarthestMoving) continue;
    placed.push_back({p.x(), p.y(), range, r.height[i]});
    bins.push_back(static_cast<std::uint16_t>(azimuthBinOf(p.x(), p.y())));
    ++at_[bins.back() + std::size_t{1}];
  }
  for (std::size_t b = 0; b < kAzimuthBins; ++b) at_[b + 1] += at_[b];
  before_.resize(placed.size());
  std::vector<std::uint32_t> next(at_.begin(), at_.end() - 1);
  for (std::size_t i = 0; i < placed.size(); ++i) before_[next[bins[i]]++] = placed[i];
}

std::optional<MovingCluster> RadialMotion::of(const std::vector<std::uint32_t>& points) const {
  if (points.size() < kFewestMoving || before_.empty()) return {};
  const Vector2 sensor = now_.points.sensor.head<2>();
  std::vector<Return> seen;
  seen.reserve(points.size());
  Vector2 middle = Vector2::Zero();
  double mean_range = 0;
  for (const std::uint32_t k : points) {
    const Vector2 d = Vector2(now_.x[k], now_.y[k]) - sensor;
    middle += d;
    mean_range += d.norm();
    seen.push_back({static_cast<float>(d.x()), static_cast<float>(d.y()),
                    static_cast<float>(d.norm()), now_.above[k]});
  }
  mean_range /= static_cast<double>(seen.size());
  const Vector2 u = middle.normalized(), left(-u.y(), u.x());
  const double cell = kCellWidth / mean_range;  // [rad], nearly the sine
  const auto cellOf = [&](const Return& r) {
    const double across = (left.x() * r.x + left.y() * r.y) / r.range;
    const double along = u.x() * r.x + u.y() * r.y;
    const auto column = static_cast<int>(std::floor(across / cell)) + kFlowColumns / 2;
    const auto row = static_cast<int>(r.height / kCellHeight);
    return along <= 0 || column < 0 || column >= kFlowColumns || row < 0 || row >= kFlowRows
               ? -1
               : row * kFlowColumns + column;
  };
  struct InCell {
    std::array<float, kMostInCell> range{};
    std::size_t n = 0;
    void add(float r) {
      if (n < kMostInCell) range[n] = r;
      n += n < kMostInCell;
    }
  };
  std::vector<InCell> now(kFlowRows * kFlowColumns), then(kFlowRows * kFlowColumns);
  double first = 1, last = -1;
  for (const Return& r : seen) {
    const int c = cellOf(r);
    if (c < 0) continue;
    now[static_cast<std::size_t>(c)].add(r.range);
    const double across = (left.x() * r.x + left.y() * r.y) / r.range;
    first = std::min(first, across), last = std::max(last, across);
  }
  if (first > last) return {};
  const double azimuth = std::atan2(u.y(), u.x());
  const double per_bin = kTwoPi / kAzimuthBins;
  const auto from = static_cast<std::int64_t>(std::floor((azimuth + std::asin(first)) / per_bin)) - 1,
             to = static_cast<std::int64_t>(std::floor((azimuth + std::asin(last)) / per_bin)) + 1;
  for (std::int64_t b = from; b <= to; ++b) {
    const auto bin = static_cast<std::size_t>(((b % std::int64_t{kAzimuthBins}) + kAzimuthBins) % kAzimuthBins);
    for (std::uint32_t k = at_[bin]; k < at_[bin + 1]; ++k) {
      const int c = cellOf(before_[k]);
      if (c >= 0 && now[static_cast<std::size_t>(c)].n > 0)
        then[static_cast<std::size_t>(c)].add(before_[k].range);
    }
  }
  const auto most = static_cast<int>(std::ceil(kFastest * dt_ / kWayStep));
  std::vector<double> votes(static_cast<std::size_t>(2 * most + 1), 0);
  const auto stepOf = [&](double way) { return static_cast<int>(std::lround(way / kWayStep)) + most; };
  double cells = 0;
  for (std::size_t c = 0; c < now.size(); ++c) {
    if (now[c].n == 0 || then[c].n == 0) continue;
    std::array<int, kMostInCell * kMostInCell> steps{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < now[c].n; ++i)
      for (std::size_t j = 0; j < then[c].n; ++j) {
        const int s = stepOf(now[c].range[i] - then[c].range[j]);
        if (s >= 0 && s <= 2 * most) steps[n++] = s;
      }
    for (std::size_t k = 0; k < n; ++k)
      votes[static_cast<std::size_t>(steps[k])] += 1 / static_cast<double>(n);
    cells += n > 0;
  }
  const auto about = [&](int s) {
    double sum = 0;
    for (int k = std::max(s - 1, 0); k <= std::min(s + 1, 2 * most); ++k)
      sum += votes[static_cast<std::size_t>(k)];
    return sum;
  };
  int best = 0;
  double highest = 0, other = 0;
  for (int s = 0; s <= 2 * most; ++s)
    if (about(s) > highest) highest = about(s), best = s;
  if (std::abs(best - most) * kWayStep < kLeastMoving * dt_) return {};
  for (int s = 0; s <= 2 * most; ++s)
    if (std::abs(s - best) > 4 || std::abs(s - most) <= 1) other = std::max(other, about(s));
  if (highest < kLeastDirections || highest < kLeastShare * cells || highest < kClearly * other)
    return {};
  double sum = 0, weight = 0;
  for (int s = std::max(best - 2, 0); s <= std::min(best + 2, 2 * most); ++s)
    sum += votes[static_cast<std::size_t>(s)] * (s - most) * kWayStep,
        weight += votes[static_cast<std::size_t>(s)];
  const double way = sum / weight;

  // Each return of now, and whether one of before agrees with it.
  LineOfRanges line;
  std::vector<Place> places(seen.size());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Return& r = seen[k];
    Place& p = places[k];
    p.across = left.x() * r.x + left.y() * r.y, p.range = r.range;
    const int c = cellOf(r);
    if (c < 0 || then[static_cast<std::size_t>(c)].n == 0) continue;
    const InCell& earlier = then[static_cast<std::size_t>(c)];
    p.judged = true;
    p.agrees = std::any_of(
        earlier.range.begin(), earlier.range.begin() + static_cast<std::ptrdiff_t>(earlier.n),
        [&](float e) { return std::abs(r.range - e - way) < 1.5 * kWayStep; });
    if (p.agrees) line.add(p.across, p.range);
  }
  const double slope = line.n > 0 ? line.slope() : 0;
  if (std::abs(slope) > kSteepest) return {};
  MovingCluster moving;
  moving.behind_cloud = behindCloud(places, slope, points);
  const double length = std::hypot(1, slope);
  const Vector2 normal = (u - slope * left) / length;
  RadialSpeed& speed = moving.speed;
  speed.direction =
      (ego_.T_world_ego.linear() * Vector3(normal.x(), normal.y(), 0)).head<2>().normalized();
  const double along = way / dt_ / length;
  const double approach = along - ego_.velocity.dot(speed.direction);
  speed.along = {along, std::pow(kWaySigma / dt_, 2) + std::pow(kTimeError * approach, 2)};
  return moving;
}

}  // namespace perception
