// What ClusterDescriber says of a cluster among the other returns of its scan.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "libperception/lidar/description/ClusterDescriptor.h"
#include "libperception/lidar/description/DescriptorParts.h"
#include "libperception/simd/Dispatch.h"
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
  int cut = 0;  ///< beside the rows' ends: a return before it, or not looked at
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

constexpr std::int32_t kIntensitySteps = 1024;  // of intensities

/// Without branches, so that the compiler vectorizes them: steps from the least intensity on, the
/// first of what is not finite; cells of the plane, row by row.
PERCEPTION_WIDEST void findIntensitySteps(const float* __restrict raw, std::size_t count, float low,
                                          float size, std::int32_t* __restrict step) {
  constexpr float kFinite = std::numeric_limits<float>::max();
  for (std::size_t k = 0; k < count; ++k) {
    const float share = std::abs(raw[k]) <= kFinite ? (raw[k] - low) / size : 0;
    step[k] = std::min(kIntensitySteps - 1, static_cast<std::int32_t>(share * kIntensitySteps));
  }
}
PERCEPTION_WIDEST void findPlaneCells(const float* __restrict x, const float* __restrict y,
                                      std::size_t count, float x0, float y0, int columns, int rows,
                                      std::uint32_t* __restrict cell) {
  for (std::size_t k = 0; k < count; ++k) {
    const int c = static_cast<int>((x[k] - x0) / kPlaneCell),
              r = static_cast<int>((y[k] - y0) / kPlaneCell);
    cell[k] =
        static_cast<std::uint32_t>(std::min(r, rows - 1) * columns + std::min(c, columns - 1));
  }
}

}  // namespace

/// Mid-rank among the obstacles, in 1024 steps from the least to the greatest: what a unit calls
/// its intensity differs from unit to unit by more than a scale. Empty without intensities.
void ClusterDescriber::rankIntensities(const LidarCloud& cloud) {
  const std::size_t n = found_.obstacles.size();
  if (cloud.intensity.size() != cloud.size() || n == 0) return;
  RawVector<float> raw(n);
  Interval range;
  for (std::size_t k = 0; k < n; ++k) {
    raw[k] = cloud.intensity[found_.points.source[found_.obstacles[k]]];
    if (std::isfinite(raw[k])) range.add(raw[k]);
  }
  if (range.size() <= 0) return;
  intensity_.resize(n);
  std::array<std::uint32_t, static_cast<std::size_t>(kIntensitySteps) + 1> below{};
  RawVector<std::int32_t> step(n);
  findIntensitySteps(raw.data(), n, range.low, range.size(), step.data());
  for (const std::int32_t s : step) ++below[static_cast<std::size_t>(s) + 1];
  std::partial_sum(below.begin(), below.end(), below.begin());
  std::array<float, static_cast<std::size_t>(kIntensitySteps)> rank;
  for (std::size_t s = 0; s < rank.size(); ++s)
    rank[s] = 0.5f * static_cast<float>(below[s] + below[s + 1]) / static_cast<float>(n);
  for (std::size_t k = 0; k < n; ++k) intensity_[k] = rank[static_cast<std::size_t>(step[k])];
}

void ClusterDescriber::sortByPlace() {
  const std::size_t n = found_.obstacles.size();
  Interval x, y;
  for (std::size_t k = 0; k < n; ++k) x.add(dx_[k]), y.add(dy_[k]);
  x0_ = x.low, y0_ = y.low;
  columns_ = n ? static_cast<int>(x.size() / kPlaneCell) + 1 : 0;
  rows_ = n ? static_cast<int>(y.size() / kPlaneCell) + 1 : 0;
  start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  rank_.resize(n);  // first the cell
  findPlaneCells(dx_.data(), dy_.data(), n, x0_, y0_, columns_, rows_, rank_.data());
  for (const std::uint32_t cell : rank_) ++start_[cell + 1];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  sorted_x_.resize(n), sorted_y_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t at = rank_[k] = next[rank_[k]]++;
    sorted_x_[at] = dx_[k], sorted_y_[at] = dy_[k];
  }
}

void ClusterDescriber::describeDirections(const Members& cluster,
                                          const std::vector<std::uint32_t>& members,
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
  thread_local RawVector<int> column_of;  // of each member
  column_of.resize(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    const int row = place_[members[i]].row, column = column_of[i] = columnOf(members[i]);
    first_row = std::min(first_row, row), last_row = std::max(last_row, row);
    first_column = std::min(first_column, column), last_column = std::max(last_column, column);
  }
  const auto width = static_cast<std::size_t>(last_column - first_column + 1);
  std::vector<Row> rows(static_cast<std::size_t>(last_row - first_row + 1));
  std::vector<std::uint8_t> mine(rows.size() * width, 0), column_hit(width, 0);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const int column = column_of[i];
    const auto r = static_cast<std::size_t>(place_[members[i]].row - first_row);
    const auto c = static_cast<std::size_t>(column - first_column);
    Row& row = rows[r];
    row.low = std::min(row.low, column), row.high = std::max(row.high, column);
    row.hit += !mine[r * width + c];
    mine[r * width + c] = column_hit[c] = 1;
  }
  const float range = std::hypot(at(d, Feature::kRange), cluster.z[0]);
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
      n.cut += cells_.at(origin + beside, height).nearest < range - 0.7f ||
               !found_.field.has(origin + beside);
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
  values.reserve(kIntensitySample);
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

void ClusterDescriber::describeNeighbors(const Members& c,
                                         const std::vector<std::uint32_t>& members,
                                         Descriptor& d) const {
  const std::size_t stride = 1 + (members.size() - 1) / kNeighborSample;
  constexpr float kTouch = 0.6f;  // [m]
  float least = kIsolated;
  int touching = 0, count = 0;
  for (std::size_t i = 0; i < members.size(); i += stride) {
    const float other = nearestOther(c, members[i], std::max(least, kTouch));
    least = std::min(least, other);
    touching += other < kTouch, ++count;
  }
  at(d, Feature::kIsolation) = least;
  at(d, Feature::kTouching) = static_cast<float>(touching) / static_cast<float>(count);
}

namespace {

/// The least of `best` and the squared distances [m^2] of points without that mark from a place.
PERCEPTION_WIDER float nearestOf(const float* x, const float* y, const std::int32_t* mark,
                                 std::size_t count, float px, float py, std::int32_t own,
                                 float best) {
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
float ClusterDescriber::nearestOther(const Members& cluster, std::uint32_t i, float within) const {
  constexpr float kRounding = 1e-3f;  // [m] more than floats round
  const float x = dx_[i], y = dy_[i];
  const int c = std::min(static_cast<int>((x - x0_) / kPlaneCell), columns_ - 1),
            r = std::min(static_cast<int>((y - y0_) / kPlaneCell), rows_ - 1);
  // From the borders of its cell [m].
  const float left = x - x0_ - static_cast<float>(c) * kPlaneCell, right = kPlaneCell - left;
  const float below = y - y0_ - static_cast<float>(r) * kPlaneCell, above = kPlaneCell - below;
  float best = within * within;
  const auto look = [&](int row, int first_column, int last_column) {
    first_column = std::max(first_column, 0), last_column = std::min(last_column, columns_ - 1);
    if (row < 0 || row >= rows_ || first_column > last_column) return;
    const std::size_t cells = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const std::uint32_t first = start_[cells + static_cast<std::size_t>(first_column)],
                        end = start_[cells + static_cast<std::size_t>(last_column) + 1];
    if (first < end)
      best = nearestOf(sorted_x_.data() + first, sorted_y_.data() + first,
                       cluster.number.data() + first, end - first, x, y, cluster.own, best);
  };
  // Cells from its own to the one in which something nearer may be, past a border.
  const auto cellsPast = [](float reach, float border) {
    return reach > border ? 1 + static_cast<int>((reach - border) / kPlaneCell) : 0;
  };
  // What may be nearer in a row that begins `between` [m] away: in its middle three cells, or
  // beside those.
  const auto lookIn = [&](int row, float between, bool middle, bool beside) {
    const float least = std::max(between - kRounding, 0.0f);
    if (least * least >= best) return false;
    const float reach = std::sqrt(best - least * least) + kRounding;
    const int before = cellsPast(reach, left), after = cellsPast(reach, right);
    if (middle && beside) {
      look(row, c - before, c + after);
    } else if (middle) {
      look(row, c - std::min(before, 1), c + std::min(after, 1));
    } else {
      look(row, c - before, c - 2), look(row, c + 2, c + after);
    }
    return true;
  };
  lookIn(r, 0, true, false), lookIn(r - 1, below, true, false), lookIn(r + 1, above, true, false);
  lookIn(r, 0, false, true);
  for (int away = 1;; ++away) {
    const float between = static_cast<float>(away - 1) * kPlaneCell;
    const bool any_below = lookIn(r - away, between + below, away > 1, true),
               any_above = lookIn(r + away, between + above, away > 1, true);
    if (!any_below && !any_above) break;
  }
  return std::sqrt(best);
}

}  // namespace perception
