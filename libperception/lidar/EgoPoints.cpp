#include "libperception/lidar/EgoPoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace perception {

void PointParams::visit(ParamVisitor& v) {
  v.real("vehicle_front", vehicle_front, {0, 20}, "m", "own vehicle ahead of the ego origin");
  v.real("vehicle_rear", vehicle_rear, {0, 20}, "m", "own vehicle behind the ego origin");
  v.boolean("only_objects", only_objects,
            "only returns that the scanner itself labels as object, if it labels returns");
  v.expert();
  v.real(
      "range_max", range_max, {5, 300}, "m",
      "horizontal range beyond which returns are dropped, but not where the vehicle could not stop "
      "within it");
  v.real("vehicle_side", vehicle_side, {0, 5}, "m", "own vehicle to each side of the ego origin");
  v.real("vehicle_top", vehicle_top, {0, 6}, "m", "own vehicle above the ground");
  v.require(range_min < range_max, "range_max must be above 0.5 m");
}

namespace {

constexpr float kMaxRange2 = 1e3f * 1e3f;  // [m^2]
constexpr std::size_t kBlock = 512;        // points that fit in the L1 cache
constexpr std::size_t kAhead = 512;        // points of prefetch distance
constexpr std::size_t kTaken = 16;         // points per cache line, subsampled together

bool isDroppedByLabel(std::uint8_t label, bool only_objects) {
  if (only_objects) return label != static_cast<std::uint8_t>(PointLabel::kObject);
  return label == static_cast<std::uint8_t>(PointLabel::kRain) ||
         label == static_cast<std::uint8_t>(PointLabel::kDirt);
}

/// Marks of one block of a cloud, and a copy of its points where they are not contiguous.
struct Block {
  std::array<float, kBlock> px, py, pz;   ///< [m] sensor frame, when the cloud is thinned
  std::array<std::int32_t, kBlock> keep;  ///< 0 or 1
};

/// Output of a block's points, behind those already kept.
struct Places {
  Places(EgoPoints& points, std::size_t first)
      : x(&points.x[first]),
        y(&points.y[first]),
        z(&points.z[first]),
        source(&points.source[first]) {}
  float *x, *y, *z;  ///< [m] ego frame
  std::uint32_t* source;
};

struct BlockCounts {
  std::int32_t kept = 0, with_range = 0;  ///< counts
};

/// The bounds of PointParams in floats, and the sensor's pose.
struct Rules {
  Rules(const SensorFrame& frame, const PointParams& params)
      : R(frame.T_ego_sensor.linear().cast<float>()),
        t(frame.T_ego_sensor.translation().cast<float>()),
        near2(static_cast<float>(params.range_min * params.range_min)),
        far2(static_cast<float>(params.range_max * params.range_max)),
        front(static_cast<float>(params.vehicle_front)),
        rear(static_cast<float>(-params.vehicle_rear)),
        side(static_cast<float>(params.vehicle_side)),
        top(static_cast<float>(params.vehicle_top)) {}
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
  float near2, far2, front, rear, side, top;
};

/// Transforms and tests `count` points from `first` on; without branches, so that the compiler
/// vectorizes it.
PERCEPTION_WIDEST BlockCounts judge(const float* __restrict px, const float* __restrict py,
                                    const float* __restrict pz, std::uint32_t first,
                                    std::size_t count, const Rules& rules, float* __restrict ex,
                                    float* __restrict ey, float* __restrict ez,
                                    std::uint32_t* __restrict source,
                                    std::int32_t* __restrict keep) {
  const float r00 = rules.R(0, 0), r01 = rules.R(0, 1), r02 = rules.R(0, 2), tx = rules.t.x();
  const float r10 = rules.R(1, 0), r11 = rules.R(1, 1), r12 = rules.R(1, 2), ty = rules.t.y();
  const float r20 = rules.R(2, 0), r21 = rules.R(2, 1), r22 = rules.R(2, 2), tz = rules.t.z();
  const float near2 = rules.near2, far2 = rules.far2, front = rules.front, rear = rules.rear,
              side = rules.side, top = rules.top;
  BlockCounts all;
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k) {
    const float range2 = px[k] * px[k] + py[k] * py[k] + pz[k] * pz[k];
    const float x = r00 * px[k] + r01 * py[k] + r02 * pz[k] + tx;
    const float y = r10 * px[k] + r11 * py[k] + r12 * pz[k] + ty;
    const float z = r20 * px[k] + r21 * py[k] + r22 * pz[k] + tz;
    const float dx = x - tx, dy = y - ty, horizontal2 = dx * dx + dy * dy;
    // False for NaN, too.
    const std::int32_t has_range = (range2 > 0) & (range2 < kMaxRange2);
    const std::int32_t within = (horizontal2 >= near2) & (horizontal2 <= far2);
    const std::int32_t own = (x < front) & (x > rear) & (y < side) & (y > -side) & (z < top);
    const std::int32_t kept = has_range & within & (own ^ 1);
    ex[k] = x, ey[k] = y, ez[k] = z, source[k] = first + k, keep[k] = kept;
    all.with_range += has_range, all.kept += kept;
  }
  return all;
}

/// Moves the kept points to the front; returns how many they are.
std::size_t squeeze(const Block& block, std::size_t size, const Places& at) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < size; ++k) {  // a dropped point is overwritten by the next
    at.x[kept] = at.x[k], at.y[kept] = at.y[k], at.z[kept] = at.z[k];
    at.source[kept] = at.source[k];
    kept += static_cast<std::size_t>(block.keep[k]);
  }
  return kept;
}

/// Most groups have the full size, for which the copy is inlined.
void copyGroup(const float* from, std::size_t count, float* to) {
  if (count == kTaken) {
    std::memcpy(to, from, kTaken * sizeof *to);
  } else {
    std::copy_n(from, count, to);
  }
}

void resize(EgoPoints& points, std::size_t size) {
  for (auto* axis : {&points.x, &points.y, &points.z}) axis->resize(size);
  points.source.resize(size);
}

/// Prefetches the next points: hardware prefetchers stop at page borders.
void prefetch(const LidarCloud& cloud, std::size_t first, std::size_t count) {
  for (const auto* axis : {&cloud.x, &cloud.y, &cloud.z})
    for (std::size_t k = first; k < std::min(first + count, axis->size()); k += kTaken)
      __builtin_prefetch(axis->data() + k);
}

}  // namespace

EgoPoints usablePoints(const SensorFrame& frame, const PointParams& params) {
  EgoPoints points;
  points.sensor = frame.T_ego_sensor.translation();
  points.reach = params.range_max;
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr || cloud->size() == 0) return points;
  // A scan that is too large is subsampled by whole groups of neighbors.
  const std::size_t stride =
      1 + (cloud->size() - 1) / static_cast<std::size_t>(std::max(params.max_points, 1));
  const auto index = [stride](std::size_t k) { return k / kTaken * kTaken * stride + k % kTaken; };
  const std::size_t groups = (cloud->size() + kTaken * stride - 1) / (kTaken * stride);
  const std::size_t in_last = std::min(kTaken, cloud->size() - (groups - 1) * kTaken * stride);
  const std::size_t count = (groups - 1) * kTaken + in_last;
  points.capped = cloud->size() - count;
  points.x.reserve(count), points.y.reserve(count), points.z.reserve(count);
  points.source.reserve(count);

  const Rules rules(frame, params);
  Block block;
  std::size_t kept = 0;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min(kBlock, count - first);
    const float *px = &cloud->x[first], *py = &cloud->y[first], *pz = &cloud->z[first];
    resize(points, kept + size);
    const Places at(points, kept);
    if (stride == 1) {
      prefetch(*cloud, first + kBlock, kBlock);
    } else {
      for (std::size_t k = 0; k < size; k += kTaken) {
        const std::size_t i = index(first + k), taken = std::min(kTaken, size - k);
        prefetch(*cloud, index(first + k + kAhead), 1);
        copyGroup(&cloud->x[i], taken, &block.px[k]);
        copyGroup(&cloud->y[i], taken, &block.py[k]);
        copyGroup(&cloud->z[i], taken, &block.pz[k]);
      }
      px = block.px.data(), py = block.py.data(), pz = block.pz.data();
    }
    const BlockCounts all = judge(px, py, pz, static_cast<std::uint32_t>(first), size, rules, at.x,
                                  at.y, at.z, at.source, block.keep.data());
    if (stride > 1)
      for (std::size_t k = 0; k < size; ++k)
        at.source[k] = static_cast<std::uint32_t>(index(first + k));
    points.dropped += size - static_cast<std::size_t>(all.with_range);
    if (!cloud->label.empty())
      for (std::size_t k = 0; k < size; ++k)
        if (isDroppedByLabel(cloud->label[index(first + k)], params.only_objects))
          block.keep[k] = 0;
    const bool whole = cloud->label.empty() && static_cast<std::size_t>(all.kept) == size;
    kept += whole ? size : squeeze(block, size, at);
  }
  resize(points, kept);
  return points;
}

/// A subsample suffices: the highest beam has its share of the returns.
double topSlope(const EgoPoints& points) {
  constexpr std::size_t kSample = 16000;
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             sz = static_cast<float>(points.sensor.z());
  const std::size_t stride = 1 + points.size() / kSample;
  float top = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const float dx = points.x[i] - sx, dy = points.y[i] - sy;
    top = std::max(top, (points.z[i] - sz) / std::sqrt(dx * dx + dy * dy));
  }
  return static_cast<double>(top);
}

}  // namespace perception
