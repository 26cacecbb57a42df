#include "libperception/lidar/outline/RadialMotion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"
#include "libperception/lidar/outline/RangeFlow.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {
namespace {

// All assumed.
constexpr std::int64_t kAzimuthBins = 1440;  // 0.25 deg
constexpr float kFarthestMoving = 80;        // [m] from the sensor
constexpr std::size_t kFewestMoving = 20;    // returns of a cluster
constexpr double kMostTime = 0.25;           // [s] between two scans
// Cells of direction, so small that a surface is flat in them.
constexpr double kCellWidth = 0.15, kCellHeight = 0.2;  // [m]
constexpr int kWayRows = 16, kMostColumns = 128;
constexpr double kWaySigma = 0.1;  // [m] of a way, with the errors of the poses
// Of the time between two looks, which is not quite that between the stamps.
constexpr double kTimeError = 0.1;
constexpr double kSteepest = 0.5;   // [-] of the surface across the line of sight
constexpr double kNarrowest = 0.1;  // [m] deviation of what tells how steep it is
// What hangs before a surface that has moved.
constexpr double kSurfaceDepth = 0.4, kBefore = 0.2;  // [m] of the surface, and nearer than it
constexpr double kLeastOfCloud = 0.1;                 // of the cluster's returns
constexpr std::size_t kCloudToOwn = 2;                // times as many as move along
constexpr double kOutermost = 0.03, kBeyond = 0.1;    // of the surface's returns; [m]

std::int64_t azimuthBinOf(float x, float y) {
  const auto turn = fastAtan2(x, y) * static_cast<float>(1 / kTwoPi) + 1;
  return static_cast<std::int64_t>(turn * static_cast<float>(kAzimuthBins)) % kAzimuthBins;
}

/// A return of a cluster.
struct Seen {
  double across = 0, range = 0;         ///< [m] to the left of the middle, from the sensor
  bool judged = false, agrees = false;  ///< seen in the scan before, and by the same way
};

/// Change of the range over the way across, of the returns that have moved alike; 0 of what is too
/// narrow to tell.
double slopeOf(const std::vector<Seen>& seen) {
  double n = 0, y = 0, r = 0, yy = 0, yr = 0;
  for (const Seen& s : seen) {
    if (!s.agrees) continue;
    ++n, y += s.across, r += s.range, yy += s.across * s.across, yr += s.across * s.range;
  }
  const double spread = n > 0 ? yy - y * y / n : 0;
  return spread <= n * kNarrowest * kNarrowest ? 0 : (yr - y * r / n) / spread;
}

/// The least depth [m] of the layer that holds most of the returns that have moved alike.
std::optional<double> layerOf(std::vector<double> depths) {
  std::sort(depths.begin(), depths.end());
  std::size_t best = 0, most = 0;
  for (std::size_t i = 0, end = 0; i < depths.size(); ++i) {
    while (end < depths.size() && depths[end] - depths[i] <= kSurfaceDepth) ++end;
    if (end - i > most) most = end - i, best = i;
  }
  if (most == 0) return std::nullopt;
  return depths[best];
}

/// See MovingCluster::behind_cloud.
std::vector<std::uint32_t> behindCloud(const std::vector<Seen>& seen, double slope,
                                       const std::vector<std::uint32_t>& points) {
  const auto depthOf = [slope](const Seen& s) { return s.range - slope * s.across; };
  std::vector<double> depths;
  for (const Seen& s : seen)
    if (s.agrees) depths.push_back(depthOf(s));
  const auto nearest = layerOf(std::move(depths));
  if (!nearest) return {};
  std::size_t strange = 0, own = 0;
  std::vector<double> across;
  for (const Seen& s : seen) {
    const double into = depthOf(s) - *nearest;
    if (s.agrees && into >= 0 && into <= kSurfaceDepth) across.push_back(s.across);
    if (s.judged && into < -kBefore) ++(s.agrees ? own : strange);
  }
  if (static_cast<double>(strange) < kLeastOfCloud * static_cast<double>(seen.size()) ||
      strange < own * kCloudToOwn)
    return {};
  std::sort(across.begin(), across.end());
  const auto quantile = [&](double q) {
    return across[static_cast<std::size_t>(q * static_cast<double>(across.size() - 1))];
  };
  const double right = quantile(kOutermost) - kBeyond, left = quantile(1 - kOutermost) + kBeyond;
  std::vector<std::uint32_t> kept;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double a = seen[k].across;
    if (depthOf(seen[k]) >= *nearest - kBefore && a >= right && a <= left)
      kept.push_back(points[k]);
  }
  return kept;
}

}  // namespace

/// Cells of direction about the middle of a cluster, as many as it covers.
class RadialMotion::Cells {
 public:
  explicit Cells(const std::vector<Return>& returns) {
    Vector2 sum = Vector2::Zero();
    double range = 0;
    for (const Return& r : returns) {
      sum += Vector2(static_cast<double>(r.x), static_cast<double>(r.y));
      range += static_cast<double>(r.range);
      nearest = std::min(nearest, r.range), farthest = std::max(farthest, r.range);
    }
    ahead = sum.normalized(), left = {-ahead.y(), ahead.x()};
    for (const Return& r : returns)
      rightmost = std::min(rightmost, sine(r)), leftmost = std::max(leftmost, sine(r));
    per_sine_ = range / static_cast<double>(returns.size()) / kCellWidth;
    columns_ = static_cast<int>((leftmost - rightmost) * per_sine_) + 1;
  }

  bool tooWide() const { return columns_ > kMostColumns; }
  std::size_t number() const { return static_cast<std::size_t>(columns_ * kWayRows); }
  /// [m] to the left of the middle
  double across(const Return& r) const {
    return left.x() * static_cast<double>(r.x) + left.y() * static_cast<double>(r.y);
  }
  std::optional<std::size_t> of(const Return& r) const {
    if (ahead.x() * static_cast<double>(r.x) + ahead.y() * static_cast<double>(r.y) <= 0)
      return std::nullopt;
    const auto column = static_cast<int>(std::floor((sine(r) - rightmost) * per_sine_));
    const auto row = static_cast<int>(static_cast<double>(r.height) / kCellHeight);
    if (column < 0 || column >= columns_ || row < 0 || row >= kWayRows) return std::nullopt;
    return static_cast<std::size_t>(column * kWayRows + row);
  }

  Vector2 ahead, left;
  double rightmost = 1, leftmost = -1;  ///< sines of the angles to the middle
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;  ///< [m]

 private:
  double sine(const Return& r) const { return across(r) / static_cast<double>(r.range); }

  double per_sine_ = 0;  ///< columns
  int columns_ = 0;
};

RadialMotion::RadialMotion(const EarlierScan& before, const LidarDetections& now,
                           const EgoState& ego, Stamp stamp)
    : now_(now),
      ego_(ego),
      dt_(stamp - before.stamp),
      at_(static_cast<std::size_t>(kAzimuthBins) + 1, 0) {
  if (!(dt_ > 0) || dt_ > kMostTime) return;
  const Eigen::Isometry3f T = (ego.T_world_ego.inverse() * before.T_world_ego).cast<float>();
  const PlacedReturns& r = *before.returns;
  const auto lowest = static_cast<float>(r.height_min), highest = static_cast<float>(r.height_max);
  const Eigen::Vector3f sensor = now.points.sensor.cast<float>();
  std::vector<Return> placed;
  std::vector<std::size_t> bins;
  placed.reserve(r.size()), bins.reserve(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r.height[i] < lowest || r.height[i] > highest) continue;
    const Eigen::Vector3f p = T * Eigen::Vector3f(r.x[i], r.y[i], r.z[i]) - sensor;
    const float range = std::sqrt(p.x() * p.x() + p.y() * p.y());
    if (range > kFarthestMoving) continue;
    placed.push_back({p.x(), p.y(), range, r.height[i]});
    bins.push_back(static_cast<std::size_t>(azimuthBinOf(p.x(), p.y())));
    ++at_[bins.back() + 1];
  }
  for (std::size_t b = 1; b < at_.size(); ++b) at_[b] += at_[b - 1];
  before_.resize(placed.size());
  std::vector<std::uint32_t> next(at_.begin(), at_.end() - 1);
  for (std::size_t i = 0; i < placed.size(); ++i) before_[next[bins[i]]++] = placed[i];
}

std::vector<RadialMotion::Return> RadialMotion::returnsOf(
    const std::vector<std::uint32_t>& points) const {
  const auto sx = static_cast<float>(now_.points.sensor.x()),
             sy = static_cast<float>(now_.points.sensor.y());
  std::vector<Return> returns;
  returns.reserve(points.size());
  for (const std::uint32_t k : points) {
    const float x = now_.x[k] - sx, y = now_.y[k] - sy;
    returns.push_back({x, y, std::sqrt(x * x + y * y), now_.above[k]});
  }
  return returns;
}

std::optional<MovingCluster> RadialMotion::of(const std::vector<std::uint32_t>& points) const {
  if (points.size() < kFewestMoving || before_.empty()) return std::nullopt;
  const std::vector<Return> returns = returnsOf(points);
  const Cells cells(returns);
  if (cells.tooWide()) return std::nullopt;
  RangeFlow ways(cells.number());
  std::vector<std::optional<std::size_t>> cell_of;
  cell_of.reserve(returns.size());
  for (const Return& r : returns) {
    cell_of.push_back(cells.of(r));
    if (cell_of.back()) ways.addNow(*cell_of.back(), r.range);
  }
  const double azimuth = std::atan2(cells.ahead.y(), cells.ahead.x());
  constexpr double kPerBin = kTwoPi / static_cast<double>(kAzimuthBins);
  const auto binAt = [&](double sine) {
    return static_cast<std::int64_t>(std::floor((azimuth + std::asin(sine)) / kPerBin));
  };
  const auto farthest_way = static_cast<float>(RangeFlow::kFastest * dt_);
  const float least = cells.nearest - farthest_way, most = cells.farthest + farthest_way;
  const std::int64_t last = binAt(cells.leftmost) + 1;
  for (std::int64_t b = binAt(cells.rightmost) - 1; b <= last; ++b) {
    const auto bin = static_cast<std::size_t>((b % kAzimuthBins + kAzimuthBins) % kAzimuthBins);
    for (std::uint32_t k = at_[bin]; k < at_[bin + 1]; ++k) {
      const Return& r = before_[k];
      if (r.range < least || r.range > most) continue;
      if (const auto cell = cells.of(r)) ways.addBefore(*cell, r.range);
    }
  }
  const std::optional<double> way = ways.way(dt_);
  if (!way) return std::nullopt;

  std::vector<Seen> seen(returns.size());
  for (std::size_t k = 0; k < returns.size(); ++k) {
    seen[k].across = cells.across(returns[k]);
    seen[k].range = static_cast<double>(returns[k].range);
    seen[k].judged = cell_of[k] && ways.seenBefore(*cell_of[k]);
    seen[k].agrees = seen[k].judged && ways.agrees(*cell_of[k], returns[k].range, *way);
  }
  const double slope = slopeOf(seen);
  if (std::abs(slope) > kSteepest) return std::nullopt;
  MovingCluster moving;
  moving.behind_cloud = behindCloud(seen, slope, points);
  const Vector2 normal = cells.ahead - slope * cells.left;
  moving.speed.direction =
      (ego_.T_world_ego.linear() * Vector3(normal.x(), normal.y(), 0)).head<2>().normalized();
  const double along = *way / dt_ / std::hypot(1, slope);
  const double approach = along - ego_.velocity.dot(moving.speed.direction);
  const double timing = kTimeError * approach, placing = kWaySigma / dt_;
  moving.speed.along = {along, placing * placing + timing * timing};
  return moving;
}

}  // namespace perception
