// What ClusterDescriber says of a cluster among the other returns of its scan.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "libperception/lidar/description/ClusterDescriptor.h"
#include "libperception/lidar/description/DescriptorParts.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr float kPlaneCell = 0.5f;  // [m] of the search for neighbors
constexpr float kIsolated = 3;      // [m] farther neighbors are not looked for
constexpr std::size_t kNeighborSample = 24, kIntensitySample = 400;
/// Of a cluster in a scan without intensities: medians over 491 clusters of ten scans of KITTI 0000
/// (counted). No spread is what flakes have.
constexpr float kUsualMean = 0.37f, kUsualSpread = 0.24f, kUsualHigh = 0.79f;

/// DirectionCells about a cluster.
struct CellCounts {
  int hit = 0, rows = 0, columns = 0;  ///< with returns of the cluster
  int total = 0;                       ///< between the first and the last hit of each row
  int holes = 0;                       ///< of those without a return of the cluster
  int through = 0;                     ///< holes with a return behind it
  int cut = 0;                         ///< beside the ends of the rows, with a return before it
};

void addCells(const CellCounts& n, float range, Descriptor& d) {
  const auto area = static_cast<float>(DirectionCells::kPitch * DirectionCells::kPitch) * range *
                    range;  // [m^2] of a cell there
  const float seen = static_cast<float>(n.hit) * area;
  const float aspect = at(d, Feature::kAspect), height = at(d, Feature::kHeight);
  const float face = at(d, Feature::kLength) * std::sqrt(std::max(0.0f, 1 - aspect * aspect)) +
                     at(d, Feature::kWidth) * aspect;  // [m] width as seen
  at(d, Feature::kSeenArea) = seen;
  at(d, Feature::kFill) = seen / std::max(face * height, 0.02f);
  at(d, Feature::kRows) = static_cast<float>(n.rows);
  at(d, Feature::kColumns) = static_cast<float>(n.columns);
  at(d, Feature::kRowShare) =
      static_cast<float>(n.rows) * static_cast<float>(DirectionCells::kPitch) * range / height;
  at(d, Feature::kHoles) = static_cast<float>(n.holes) / static_cast<float>(n.total);
  at(d, Feature::kThrough) = static_cast<float>(n.through) / static_cast<float>(n.total);
  at(d, Feature::kCut) = static_cast<float>(n.cut) / static_cast<float>(2 * n.rows);
}

}  // namespace

/// Mid-rank among the obstacles, in 1024 steps from the least to the greatest: what a unit calls
/// its intensity differs from unit to unit by more than a scale. Empty without intensities.
void ClusterDescriber::rankIntensities(const LidarCloud& cloud) {
  const std::size_t n = found_.obstacles.size();
  if (cloud.intensity.size() != cloud.size() || n == 0) return;
  std::vector<float> raw(n);
  Interval range;
  for (std::size_t k = 0; k < n; ++k) {
    raw[k] = cloud.intensity[found_.points.source[found_.obstacles[k]]];
    if (std::isfinite(raw[k])) range.add(raw[k]);
  }
  if (range.size() <= 0) return;
  intensity_.resize(n);
  constexpr std::int32_t kSteps = 1024;
  std::array<std::uint32_t, static_cast<std::size_t>(kSteps) + 1> below{};
  std::vector<std::int32_t> step(n);
  for (std::size_t k = 0; k < n; ++k) {
    const float share = std::isfinite(raw[k]) ? (raw[k] - range.low) / range.size() : 0;
    step[k] = std::min(kSteps - 1, static_cast<std::int32_t>(share * kSteps));
    ++below[static_cast<std::size_t>(step[k]) + 1];
  }
  std::partial_sum(below.begin(), below.end(), below.begin());
  for (std::size_t k = 0; k < n; ++k) {
    const auto s = static_cast<std::size_t>(step[k]);
    intensity_[k] = 0.5f * static_cast<float>(below[s] + below[s + 1]) / static_cast<float>(n);
  }
}

void ClusterDescriber::sortByPlace() {
  const std::size_t n = found_.obstacles.size();
  Interval x, y;
  for (std::size_t k = 0; k < n; ++k) x.add(dx_[k]), y.add(dy_[k]);
  x0_ = x.low, y0_ = y.low;
  columns_ = n ? static_cast<int>(x.size() / kPlaneCell) + 1 : 0;
  rows_ = n ? static_cast<int>(y.size() / kPlaneCell) + 1 : 0;
  const auto cell = [&](std::size_t k) {
    const int c = static_cast<int>((dx_[k] - x0_) / kPlaneCell),
              r = static_cast<int>((dy_[k] - y0_) / kPlaneCell);
    return static_cast<std::size_t>(std::min(r, rows_ - 1)) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(std::min(c, columns_ - 1));
  };
  start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  rank_.resize(n);  // first the cell
  for (std::size_t k = 0; k < n; ++k) {
    rank_[k] = static_cast<std::uint32_t>(cell(k));
    ++start_[rank_[k] + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  sorted_x_.resize(n), sorted_y_.resize(n);
  sorted_mark_.assign(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t at = rank_[k] = next[rank_[k]]++;
    sorted_x_[at] = dx_[k], sorted_y_[at] = dy_[k];
  }
}

void ClusterDescriber::describeDirections(const std::vector<std::uint32_t>& members,
                                          Descriptor& d) const {
  struct Row {
    int low = 1 << 20, high = -(1 << 20), hit = 0;
  };
  const int origin = place_[members[0]].column;
  int first_row = DirectionCells::kRows, last_row = 0, first_column = 1 << 20,
      last_column = -(1 << 20);
  const auto columnOf = [&](std::uint32_t k) {
    int c = place_[k].column - origin;  // the seam lies opposite of the first member
    if (c >= DirectionCells::kColumns / 2) c -= DirectionCells::kColumns;
    if (c < -DirectionCells::kColumns / 2) c += DirectionCells::kColumns;
    return c;
  };
  for (const std::uint32_t k : members) {
    first_row = std::min<int>(first_row, place_[k].row);
    last_row = std::max<int>(last_row, place_[k].row);
    first_column = std::min(first_column, columnOf(k));
    last_column = std::max(last_column, columnOf(k));
  }
  const auto width = static_cast<std::size_t>(last_column - first_column + 1);
  std::vector<Row> rows(static_cast<std::size_t>(last_row - first_row + 1));
  std::vector<std::uint8_t> mine(rows.size() * width, 0), column_hit(width, 0);
  for (const std::uint32_t k : members) {
    const int column = columnOf(k);
    const auto r = static_cast<std::size_t>(place_[k].row - first_row);
    const auto c = static_cast<std::size_t>(column - first_column);
    Row& row = rows[r];
    row.low = std::min(row.low, column), row.high = std::max(row.high, column);
    row.hit += !mine[r * width + c];
    mine[r * width + c] = column_hit[c] = 1;
  }
  const float range = std::hypot(at(d, Feature::kRange), z_[0]);
  CellCounts n;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Row& row = rows[r];
    if (row.hit == 0) continue;
    const int height = first_row + static_cast<int>(r);
    n.hit += row.hit, ++n.rows, n.total += row.high - row.low + 1;
    for (int c = row.low; c <= row.high; ++c) {
      if (mine[r * width + static_cast<std::size_t>(c - first_column)]) continue;
      ++n.holes;
      n.through += cells_.at(origin + c, height).farthest > range + 1;
    }
    for (const int beside : {row.low - 1, row.high + 1})
      n.cut += cells_.at(origin + beside, height).nearest < range - 0.7f;
  }
  n.columns = static_cast<int>(std::count(column_hit.begin(), column_hit.end(), 1));
  addCells(n, range, d);
}

void ClusterDescriber::describeIntensity(const std::vector<std::uint32_t>& members,
                                         Descriptor& d) const {
  if (intensity_.empty()) {
    at(d, Feature::kIntensityMean) = kUsualMean;
    at(d, Feature::kIntensitySpread) = kUsualSpread;
    at(d, Feature::kIntensityHigh) = kUsualHigh;
    return;
  }
  std::vector<float> values;
  const std::size_t stride = 1 + (members.size() - 1) / kIntensitySample;
  for (std::size_t i = 0; i < members.size(); i += stride) values.push_back(intensity_[members[i]]);
  const auto n = static_cast<float>(values.size());
  const float mean = std::accumulate(values.begin(), values.end(), 0.0f) / n;
  float squares = 0;
  for (const float v : values) squares += (v - mean) * (v - mean);
  at(d, Feature::kIntensityMean) = mean;
  at(d, Feature::kIntensitySpread) = std::sqrt(squares / n);
  at(d, Feature::kIntensityHigh) = quantile(values, 0.9);
}

void ClusterDescriber::describeNeighbors(const std::vector<std::uint32_t>& members, Descriptor& d) {
  const std::size_t stride = 1 + (members.size() - 1) / kNeighborSample;
  constexpr float kTouch = 0.6f;  // [m]
  float least = kIsolated;
  int touching = 0, count = 0;
  for (std::size_t i = 0; i < members.size(); i += stride) {
    const float other = nearestOther(members[i], std::max(least, kTouch));
    least = std::min(least, other);
    touching += other < kTouch, ++count;
  }
  at(d, Feature::kIsolation) = least;
  at(d, Feature::kTouching) = static_cast<float>(touching) / static_cast<float>(count);
}

namespace {

/// The least of `best` and the squared distances [m^2] of points without that mark from a place.
float nearestOf(const float* x, const float* y, const std::int32_t* mark, std::size_t count,
                float px, float py, std::int32_t own, float best) {
  constexpr float kFar = 1e30f;
  constexpr std::size_t kFour = 4;
  Float4 nearest = all<Float4>(best);
  std::size_t k = 0;
  for (; k + kFour <= count; k += kFour) {
    Int4 marks;
    std::memcpy(&marks, mark + k, sizeof marks);
    const Float4 dx = load<Float4>(x + k) - px, dy = load<Float4>(y + k) - py;
    nearest = smaller(nearest, marks == own ? all<Float4>(kFar) : dx * dx + dy * dy);
  }
  for (; k < count; ++k)
    if (mark[k] != own)
      best = std::min(best, (x[k] - px) * (x[k] - px) + (y[k] - py) * (y[k] - py));
  return std::min({best, nearest[0], nearest[1], nearest[2], nearest[3]});
}

}  // namespace

/// Horizontal distance [m] to the nearest obstacle that is no member; at most `within`.
float ClusterDescriber::nearestOther(std::uint32_t i, float within) const {
  const float x = dx_[i], y = dy_[i];
  const int c = std::min(static_cast<int>((x - x0_) / kPlaneCell), columns_ - 1),
            r = std::min(static_cast<int>((y - y0_) / kPlaneCell), rows_ - 1);
  float best = within * within;
  const auto look = [&](int row, int first_column, int last_column) {
    first_column = std::max(first_column, 0), last_column = std::min(last_column, columns_ - 1);
    if (row < 0 || row >= rows_ || first_column > last_column) return;
    const std::size_t cells = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const std::uint32_t first = start_[cells + static_cast<std::size_t>(first_column)],
                        end = start_[cells + static_cast<std::size_t>(last_column) + 1];
    best = nearestOf(sorted_x_.data() + first, sorted_y_.data() + first,
                     sorted_mark_.data() + first, end - first, x, y, cluster_, best);
  };
  for (int row = r - 1; row <= r + 1; ++row) look(row, c - 1, c + 1);
  // Beside them, then row by row away from them, as far as something nearer may be.
  for (int away = 0;; ++away) {
    const float between = static_cast<float>(std::max(away - 1, 0)) * kPlaneCell;
    if (between * between >= best) break;
    const auto aside = 1 + static_cast<int>(std::sqrt(best - between * between) / kPlaneCell);
    for (const int row : {r - away, r + away}) {
      if (away > 1) {
        look(row, c - aside, c + aside);
      } else if (aside > 1) {
        look(row, c - aside, c - 2), look(row, c + 2, c + aside);
      }
      if (away == 0) break;
    }
  }
  return std::sqrt(best);
}

}  // namespace perception
