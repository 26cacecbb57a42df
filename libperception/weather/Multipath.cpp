#include "libperception/weather/Multipath.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "libperception/simd/Compress.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/RawVector.h"
#include "libperception/weather/HeightAboveGround.h"

namespace perception {

void MultipathParams::visit(ParamVisitor& v) {
  v.expert();
  v.boolean("enabled", enabled, "look for mirror images in a wet road");
}

namespace {

/// Counts real returns in cubes of the size of the tolerance, only in cubes around mirror images.
class Cubes {
 public:
  explicit Cubes(double edge) : edge_(edge), maybe_(1U << 16, 0) {}

  void watchAround(const Vector3& p) {
    forAround(p, [this](std::uint64_t key) {
      counts_.emplace(key, 0);
      maybe_[slotOf(key)] = 1;
    });
  }
  void add(const Vector3& p) {
    const std::uint64_t key = keyOf(at(p.x()), at(p.y()), at(p.z()));
    if (!maybe_[slotOf(key)]) return;
    const auto found = counts_.find(key);
    if (found != counts_.end()) ++found->second;
  }
  int around(const Vector3& p) const {
    int sum = 0;
    forAround(p, [&](std::uint64_t key) { sum += counts_.at(key); });
    return sum;
  }

 private:
  template <class Function>
  void forAround(const Vector3& p, const Function& function) const {
    const int x = at(p.x()), y = at(p.y()), z = at(p.z());
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) function(keyOf(x + dx, y + dy, z + dz));
  }
  int at(double v) const { return static_cast<int>(std::floor(v / edge_)); }
  static std::uint64_t keyOf(int x, int y, int z) {
    const auto part = [](int v) {
      return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v) & 0xFFFFFU);
    };
    return part(x) << 40 | part(y) << 20 | part(z);
  }
  static std::size_t slotOf(std::uint64_t key) { return (key * 0x9E3779B97F4A7C15ULL) >> 48; }

  double edge_;
  std::vector<char> maybe_;  // by hash slot: it may hold a cube of interest
  std::unordered_map<std::uint64_t, int> counts_;
};

/// About places [m, ego frame], in floats; no cube of interest lies outside.
struct WatchedBox {
  float turn[3][3], offset[3];  ///< from the sensor frame
  float low[3], high[3];

  explicit WatchedBox(const Pose3& T_ego_sensor) {
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) turn[k][j] = static_cast<float>(T_ego_sensor.linear()(k, j));
      offset[k] = static_cast<float>(T_ego_sensor.translation()[k]);
      low[k] = std::numeric_limits<float>::infinity(), high[k] = -low[k];
    }
  }
  void add(const Vector3& place) {
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<float>(place[k]);
      low[k] = std::min(low[k], v), high[k] = std::max(high[k], v);
    }
  }
  void widen(float beside) {
    for (int k = 0; k < 3; ++k) low[k] -= beside, high[k] += beside;
  }
  /// Whether a point of the sensor frame [m] may be in it.
  std::int32_t mayHold(float x, float y, float z) const {
    std::int32_t within = 1;
    for (int k = 0; k < 3; ++k) {
      const float v = turn[k][0] * x + turn[k][1] * y + turn[k][2] * z + offset[k];
      within &= static_cast<std::int32_t>(v >= low[k]) & static_cast<std::int32_t>(v <= high[k]);
    }
    return within;
  }
};

/// Marks the points above `least` [m] that may be in the box; as findHeights().
PERCEPTION_WIDEST void markWatched(const WatchedBox box, float least, const float* __restrict x,
                                   const float* __restrict y, const float* __restrict z,
                                   const float* __restrict heights, std::size_t count,
                                   std::int32_t* __restrict marks) {
  for (std::size_t i = 0; i < count; ++i)
    marks[i] = static_cast<std::int32_t>(heights[i] > least) & box.mayHold(x[i], y[i], z[i]);
}

/// Heights of all returns [m]; without branches, so that the compiler vectorizes it.
PERCEPTION_WIDEST void findHeights(const HeightAboveGround height, const float* __restrict x,
                                   const float* __restrict y, const float* __restrict z,
                                   std::size_t count, float* __restrict heights) {
  for (std::size_t i = 0; i < count; ++i) heights[i] = height.of(x[i], y[i], z[i]);
}

}  // namespace

std::vector<std::uint32_t> findMirrorImages(const SensorFrame& frame,
                                            const MultipathParams& params) {
  std::vector<std::uint32_t> found;
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr || !frame.ground.measured) return found;
  const HeightAboveGround height(frame.T_ego_sensor, frame.ground);
  const auto depth = static_cast<float>(params.depth), grade = static_cast<float>(params.grade);
  const auto far2 = static_cast<float>(params.max_range * params.max_range);
  const auto placeOf = [&](std::size_t i) {
    return Vector3(frame.T_ego_sensor * Vector3(static_cast<double>(cloud->x[i]),
                                                static_cast<double>(cloud->y[i]),
                                                static_cast<double>(cloud->z[i])));
  };
  RawVector<float> heights(cloud->size());
  struct Mirrored {
    std::uint32_t index;
    Vector3 place;  // [m] position of the mirror image, ego frame
  };
  std::vector<Mirrored> below;
  findHeights(height, cloud->x.data(), cloud->y.data(), cloud->z.data(), cloud->size(),
              heights.data());
  const auto lies_below = [lowest = -depth](float v) { return v < lowest; };  // not NaN
  for (auto at = heights.begin();
       (at = std::find_if(at, heights.end(), lies_below)) != heights.end(); ++at) {
    const auto i = static_cast<std::size_t>(at - heights.begin());
    const float flat2 = cloud->x[i] * cloud->x[i] + cloud->y[i] * cloud->y[i];
    if (!(flat2 < far2) || heights[i] > -depth - grade * std::sqrt(flat2)) continue;
    // The road is flat enough for its plane's normal to be z.
    below.push_back({static_cast<std::uint32_t>(i),
                     placeOf(i) - Vector3(0, 0, 2 * static_cast<double>(heights[i]))});
  }
  if (below.empty()) return found;

  Cubes cubes(params.tolerance);
  constexpr double kRounding = 0.01;  // [m] of floats
  WatchedBox watched(frame.T_ego_sensor);
  for (const Mirrored& image : below) cubes.watchAround(image.place), watched.add(image.place);
  watched.widen(static_cast<float>(2 * params.tolerance + kRounding));
  constexpr std::size_t kBlock = 512;  // points that fit in the L1 cache
  std::array<std::int32_t, kBlock> marks;
  std::array<std::uint32_t, kBlock + kPackSlack> places;
  for (std::size_t first = 0; first < cloud->size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, cloud->size() - first);
    markWatched(watched, depth, &cloud->x[first], &cloud->y[first], &cloud->z[first],
                &heights[first], count, marks.data());
    const std::size_t marked =
        packPlaces(marks.data(), count, static_cast<std::uint32_t>(first), places.data());
    for (std::size_t k = 0; k < marked; ++k) {
      const std::uint32_t i = places[k];
      if (cloud->trust.empty() || !(cloud->trust[i] < 0.5F)) cubes.add(placeOf(i));
    }
  }
  for (const Mirrored& image : below)
    if (cubes.around(image.place) >= params.support) found.push_back(image.index);
  return found;
}

}  // namespace perception
