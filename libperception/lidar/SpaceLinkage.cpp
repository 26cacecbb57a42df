#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "libperception/lidar/Forest.h"
#include "libperception/lidar/Linkage.h"

namespace perception {
namespace {

/// Points by cubes whose diagonal is just below the small threshold: all points of a cube are one
/// group. Cubes are sorted by column of the plane, then upward.
class Cubes {
 public:
  struct Point {
    float x, y, z;  ///< [m]
  };
  /// Cubes above one square of the plane.
  struct Column {
    std::int64_t place;         ///< column() of its square
    std::uint32_t first, last;  ///< cubes, `last` is the one after
  };
  static constexpr std::int64_t column(std::int64_t x, std::int64_t y) { return (x << 24) + y; }

  Cubes(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
        double side) {
    if (x.empty()) return;
    sort(keysOf(x, y, z, side), x, y, z);
  }

  std::size_t count() const { return level.size(); }

  std::vector<Column> columns;
  std::vector<std::int32_t> level;      ///< of each cube
  std::vector<std::uint32_t> start{0};  ///< first place of each cube's points
  std::vector<Point> points;            ///< cube by cube
  std::vector<Point> low, high;         ///< [m] about the cube's points
  std::vector<std::uint32_t> cube_of_point;

 private:
  using Key = std::pair<std::uint64_t, std::uint32_t>;  // place of the cube, number of the point

  static std::vector<Key> keysOf(const std::vector<float>& x, const std::vector<float>& y,
                                 const std::vector<float>& z, double side) {
    const auto lowest = [](const std::vector<float>& v) {
      return static_cast<double>(*std::min_element(v.begin(), v.end()));
    };
    const double x0 = lowest(x), y0 = lowest(y), z0 = lowest(z), per_meter = 1 / side;
    const auto cell = [per_meter](float v, double low) {
      return static_cast<std::int64_t>((static_cast<double>(v) - low) * per_meter);
    };
    std::vector<Key> keys;
    keys.reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::int64_t place = column(kBorder + cell(x[i], x0), kBorder + cell(y[i], y0));
      keys.emplace_back(static_cast<std::uint64_t>(place << 16 | cell(z[i], z0)),
                        static_cast<std::uint32_t>(i));
    }
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  void sort(const std::vector<Key>& keys, const std::vector<float>& x, const std::vector<float>& y,
            const std::vector<float>& z) {
    cube_of_point.resize(x.size());
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const auto& [key, i] = keys[k];
      const Point p{x[i], y[i], z[i]};
      if (k == 0 || key != keys[k - 1].first) {
        const auto place = static_cast<std::int64_t>(key >> 16);
        const auto cube = static_cast<std::uint32_t>(level.size());
        if (columns.empty() || columns.back().place != place)
          columns.push_back({place, cube, cube});
        level.push_back(static_cast<std::int32_t>(key & 0xFFFF));
        low.push_back(p), high.push_back(p), start.push_back(start.back());
        columns.back().last = cube + 1;
      }
      Point &a = low.back(), &b = high.back();
      a = {std::min(a.x, p.x), std::min(a.y, p.y), std::min(a.z, p.z)};
      b = {std::max(b.x, p.x), std::max(b.y, p.y), std::max(b.z, p.z)};
      points.push_back(p);
      ++start.back();
      cube_of_point[i] = static_cast<std::uint32_t>(level.size() - 1);
    }
  }

  static constexpr std::int64_t kBorder = 64;  // squares, so that no neighbor's number is negative
};

float squared(float v) { return v * v; }

/// Squared distance of a box from another, or from a point.
float gap2(const Cubes::Point& low, const Cubes::Point& high, const Cubes::Point& other_low,
           const Cubes::Point& other_high) {
  return squared(std::max({other_low.x - high.x, low.x - other_high.x, 0.0f})) +
         squared(std::max({other_low.y - high.y, low.y - other_high.y, 0.0f})) +
         squared(std::max({other_low.z - high.z, low.z - other_high.z, 0.0f}));
}

/// Whether some point of cube i is within sqrt(threshold2) of some point of cube j.
bool touch(const Cubes& cubes, std::uint32_t i, std::uint32_t j, float threshold2) {
  if (gap2(cubes.low[i], cubes.high[i], cubes.low[j], cubes.high[j]) > threshold2) return false;
  for (std::uint32_t p = cubes.start[i]; p < cubes.start[i + 1]; ++p) {
    const Cubes::Point& a = cubes.points[p];
    if (gap2(a, a, cubes.low[j], cubes.high[j]) > threshold2) continue;
    for (std::uint32_t q = cubes.start[j]; q < cubes.start[j + 1]; ++q) {
      const Cubes::Point& b = cubes.points[q];
      if (squared(a.x - b.x) + squared(a.y - b.y) + squared(a.z - b.z) <= threshold2) return true;
    }
  }
  return false;
}

/// Columns one way off a column that may hold points within the threshold, nearest first.
struct ColumnReach {
  std::int64_t off;     ///< of its place
  std::int32_t levels;  ///< up and down
  double gap;           ///< [m]
};

/// One half of the plane about a column, the column itself included.
std::vector<ColumnReach> reachesOf(double side, double threshold) {
  const double most = threshold * (1 + 1e-6);
  const auto reach = static_cast<std::int64_t>(std::ceil(threshold / side)) + 1;
  const auto apart = [side](std::int64_t cells) {
    return static_cast<double>(std::max<std::int64_t>(std::abs(cells) - 1, 0)) * side;
  };
  std::vector<ColumnReach> reaches;
  for (std::int64_t x = 0; x <= reach; ++x)
    for (std::int64_t y = x == 0 ? 0 : -reach; y <= reach; ++y) {
      const double gap = std::hypot(apart(x), apart(y));
      std::int32_t levels = -1;
      while (levels < reach && std::hypot(gap, apart(levels + 1)) <= most) ++levels;
      if (levels >= 0) reaches.push_back({Cubes::column(x, y), levels, gap});
    }
  std::stable_sort(reaches.begin(), reaches.end(),
                   [](const ColumnReach& a, const ColumnReach& b) { return a.gap < b.gap; });
  return reaches;
}

/// Joins the sets of two columns' cubes that hold points within the threshold; each pair once.
void linkColumns(const Cubes& cubes, const Cubes::Column& a, const Cubes::Column& b,
                 std::int32_t levels, float threshold2, const std::vector<std::uint32_t>& set,
                 Forest& forest) {
  std::uint32_t first = b.first;
  for (std::uint32_t i = a.first; i < a.last; ++i) {
    while (first < b.last && cubes.level[first] < cubes.level[i] - levels) ++first;
    const std::uint32_t from = a.first == b.first ? i + 1 : first;
    for (std::uint32_t j = from; j < b.last && cubes.level[j] <= cubes.level[i] + levels; ++j)
      if (forest.find(set[i]) != forest.find(set[j]) && touch(cubes, i, j, threshold2))
        forest.unite(set[i], set[j]);
  }
}

/// Joins all sets of cubes that hold points no farther apart than the threshold.
void link(const Cubes& cubes, double side, double threshold, const std::vector<std::uint32_t>& set,
          Forest& forest) {
  const auto threshold2 = static_cast<float>(threshold * threshold);
  for (const ColumnReach& reach : reachesOf(side, threshold)) {
    std::size_t other = 0;  // both advance together
    for (const Cubes::Column& column : cubes.columns) {
      const std::int64_t place = column.place + reach.off;
      while (other < cubes.columns.size() && cubes.columns[other].place < place) ++other;
      if (other == cubes.columns.size()) break;
      if (cubes.columns[other].place == place)
        linkColumns(cubes, column, cubes.columns[other], reach.levels, threshold2, set, forest);
    }
  }
}

}  // namespace

DoubleLinkage linkTwiceInSpace(const std::vector<float>& x, const std::vector<float>& y,
                               const std::vector<float>& z, double near_threshold,
                               double far_threshold) {
  DoubleLinkage result;
  const double side = near_threshold / std::sqrt(3.0) * (1 - 1e-5);  // rounding included
  const Cubes cubes(x, y, z, side);
  std::vector<std::uint32_t> set(cubes.count());
  std::iota(set.begin(), set.end(), 0u);
  Forest near_forest(cubes.count());
  link(cubes, side, near_threshold, set, near_forest);
  result.near = partitionOf(cubes.cube_of_point, near_forest);

  for (std::size_t i = 0; i < x.size(); ++i) set[cubes.cube_of_point[i]] = result.near.group[i];
  Forest far_forest(result.near.count);
  link(cubes, side, far_threshold, set, far_forest);
  joinNearGroups(far_forest, result);
  return result;
}

}  // namespace perception
