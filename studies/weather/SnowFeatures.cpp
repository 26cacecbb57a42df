#include "studies/weather/SnowFeatures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace perception {
namespace {

constexpr double kSameBeam = radians(0.05);  // [rad] echoes of one pulse
constexpr double kAdjacent = radians(1), kAdjacentDepth = 0.3;
constexpr double kFarNeighbor = 1;  // of the range: what has no such neighbor

/// Distances to the five nearest.
class Nearest {
 public:
  Nearest() { squares_.fill(std::numeric_limits<double>::infinity()); }
  void add(double square) {
    if (square >= squares_.back()) return;
    std::size_t k = squares_.size() - 1;
    for (; k > 0 && squares_[k - 1] > square; --k) squares_[k] = squares_[k - 1];
    squares_[k] = square;
  }
  /// The k-th, as a share of the range.
  float share(std::size_t k, double range) const {
    return static_cast<float>(std::min(kFarNeighbor, std::sqrt(squares_[k - 1]) / range));
  }

 private:
  std::array<double, 5> squares_;
};

/// Middle ranks in [0, 1] of values of which many are equal.
std::vector<double> ranksOf(const std::vector<double>& values) {
  std::vector<double> sorted = values, ranks;
  std::sort(sorted.begin(), sorted.end());
  for (const double v : values) {
    const auto [low, high] = std::equal_range(sorted.begin(), sorted.end(), v);
    ranks.push_back(.5 * static_cast<double>((low - sorted.begin()) + (high - sorted.begin())) /
                    static_cast<double>(values.size()));
  }
  return ranks;
}

}  // namespace

SnowScan comparableScan(const LidarCloud& cloud, const std::vector<std::uint16_t>& labels,
                        double height, const SnowSector& sector) {
  struct Chosen {
    std::size_t i;
    double off, range, azimuth, elevation;
  };
  std::map<std::pair<int, int>, Chosen> cells;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 p(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                    static_cast<double>(cloud.z[i]));
    const double range = p.norm();
    if (range < sector.nearest) continue;
    const double azimuth = std::atan2(p.y(), p.x()), elevation = std::asin(p.z() / range);
    if (std::abs(azimuth) > sector.azimuth || elevation < sector.lowest ||
        elevation > sector.highest) {
      continue;
    }
    const double across = azimuth / sector.across, up = elevation / sector.up;
    const Chosen is{i,
                    std::hypot((across - std::floor(across) - .5) * sector.across,
                               (up - std::floor(up) - .5) * sector.up),
                    range, azimuth, elevation};
    const auto [at, is_new] = cells.try_emplace(
        {static_cast<int>(std::floor(across)), static_cast<int>(std::floor(up))}, is);
    if (is_new) continue;
    Chosen& was = at->second;
    const bool same = std::hypot(azimuth - was.azimuth, elevation - was.elevation) < kSameBeam;
    if (same ? range < was.range : is.off < was.off) was = is;
  }
  SnowScan scan;
  scan.height = height;
  for (const auto& [cell, chosen] : cells) {
    const std::size_t i = chosen.i;
    scan.places.emplace_back(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                             static_cast<double>(cloud.z[i]));
    scan.intensity.push_back(cloud.intensity.empty() ? 0 : static_cast<double>(cloud.intensity[i]));
    scan.snow.push_back(labels[i] == kSnowLabel);
  }
  return scan;
}

std::vector<SnowFeatures> snowFeatures(const SnowScan& scan, const SnowSector& sector) {
  const std::vector<double> ranks = ranksOf(scan.intensity);
  std::vector<SnowFeatures> rows;
  for (std::size_t i = 0; i < scan.places.size(); ++i) {
    const Vector3& p = scan.places[i];
    const double range = p.norm();
    if (!scan.snow[i] || range > sector.farthest) continue;
    Nearest all, snow;
    int adjacent = 0;
    for (std::size_t j = 0; j < scan.places.size(); ++j) {
      if (j == i) continue;
      const Vector3& q = scan.places[j];
      const double square = (p - q).squaredNorm();
      all.add(square);
      if (!scan.snow[j]) continue;
      snow.add(square);
      const double other = q.norm();
      adjacent += std::abs(other - range) < kAdjacentDepth &&
                  p.dot(q) > std::cos(kAdjacent) * range * other;
    }
    rows.push_back({static_cast<float>(range), static_cast<float>(ranks[i]), all.share(1, range),
                    all.share(3, range), all.share(5, range), snow.share(1, range),
                    snow.share(3, range), snow.share(5, range), static_cast<float>(adjacent),
                    static_cast<float>(p.z() + scan.height)});
  }
  return rows;
}

}  // namespace perception
