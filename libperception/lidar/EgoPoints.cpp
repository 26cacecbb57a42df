#include "libperception/lidar/EgoPoints.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

#include "libperception/core/Lanes.h"

namespace perception {

void PointParams::visit(ParamVisitor& v) {
  v.real("range_min", range_min, {0, 10}, "m", "horizontal range below which returns are dropped");
  v.real("range_max", range_max, {5, 300}, "m",
         "horizontal range beyond which returns are dropped");
  v.real("vehicle_front", vehicle_front, {0, 20}, "m", "own body ahead of the ego origin");
  v.real("vehicle_rear", vehicle_rear, {0, 20}, "m", "own body behind the ego origin");
  v.real("vehicle_side", vehicle_side, {0, 5}, "m", "own body to each side of the ego origin");
  v.real("vehicle_top", vehicle_top, {0, 6}, "m", "own body above the ground");
  v.boolean("only_objects", only_objects,
            "returns that the scanner itself labels as object, where it labels at all (SPEC 1)");
  v.integer("max_points", max_points, {1000, 100000000},
            "returns of a scan; larger scans are thinned evenly");
  v.require(range_min < range_max, "range_min must be below range_max");
}

namespace {

constexpr float kBeyondAnyLidar2 = 1e3f * 1e3f;  // [m^2]
constexpr std::size_t kBlock = 512;              // points that stay in the nearest cache
constexpr std::size_t kAhead = 512;  // points by which far places of the scan are asked for early
constexpr std::size_t kTaken = 16;   // neighbours of a line of the cache, taken together

bool ownProcessingDropsIt(std::uint8_t label, bool only_objects) {
  if (only_objects) return label != static_cast<std::uint8_t>(PointLabel::kObject);
  return label == static_cast<std::uint8_t>(PointLabel::kRain) ||
         label == static_cast<std::uint8_t>(PointLabel::kDirt);
}

/// One block of a cloud: its points in the ego frame and which of them are usable.
struct Block {
  std::array<float, kBlock> px, py, pz;  ///< [m] sensor frame, when the cloud is thinned
  std::array<float, kBlock> x, y, z;     ///< [m] ego frame
  std::array<std::int32_t, kBlock> keep, has_range;  ///< 0 or 1
  std::array<std::uint32_t, kBlock> source;
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

/// Transforms and judges `count` points; no branches, so that the compiler makes vectors of it.
PERCEPTION_WIDER void judge(const float* px, const float* py, const float* pz, std::size_t count,
                            const Rules& rules, Block& block) {
  const float r00 = rules.R(0, 0), r01 = rules.R(0, 1), r02 = rules.R(0, 2), tx = rules.t.x();
  const float r10 = rules.R(1, 0), r11 = rules.R(1, 1), r12 = rules.R(1, 2), ty = rules.t.y();
  const float r20 = rules.R(2, 0), r21 = rules.R(2, 1), r22 = rules.R(2, 2), tz = rules.t.z();
  const float near2 = rules.near2, far2 = rules.far2, front = rules.front, rear = rules.rear,
              side = rules.side, top = rules.top;
  for (std::size_t k = 0; k < count; ++k) {
    const float range2 = px[k] * px[k] + py[k] * py[k] + pz[k] * pz[k];
    const float x = r00 * px[k] + r01 * py[k] + r02 * pz[k] + tx;
    const float y = r10 * px[k] + r11 * py[k] + r12 * pz[k] + ty;
    const float z = r20 * px[k] + r21 * py[k] + r22 * pz[k] + tz;
    const float dx = x - tx, dy = y - ty, horizontal2 = dx * dx + dy * dy;
    // False also where something is not a number.
    const std::int32_t has_range = (range2 > 0) & (range2 < kBeyondAnyLidar2);
    const std::int32_t within = (horizontal2 >= near2) & (horizontal2 <= far2);
    const std::int32_t own = (x < front) & (x > rear) & (y < side) & (y > -side) & (z < top);
    block.x[k] = x, block.y[k] = y, block.z[k] = z;
    block.has_range[k] = has_range;
    block.keep[k] = has_range & within & (own ^ 1);
  }
}

/// Moves what is kept to the front; the number of it. Most is kept, so groups move as a whole.
std::size_t squeeze(Block& block, std::size_t size) {
  constexpr std::size_t kGroup = kLanes;
  std::size_t kept = 0;
  const auto move = [&block, &kept](std::size_t from) {
    block.x[kept] = block.x[from], block.y[kept] = block.y[from];
    block.z[kept] = block.z[from], block.source[kept] = block.source[from], ++kept;
  };
  const auto moveGroup = [&block, &kept](std::size_t from) {
    for (auto* lane : {&block.x, &block.y, &block.z}) store8(load8(&(*lane)[from]), &(*lane)[kept]);
    std::uint32_t group[kGroup];
    std::memcpy(group, &block.source[from], sizeof group);
    std::memcpy(&block.source[kept], group, sizeof group);
    kept += kGroup;
  };
  for (std::size_t first = 0; first < size; first += kGroup) {
    std::uint64_t marks[kGroup / 2] = {};  // of two points each
    if (first + kGroup <= size) std::memcpy(marks, &block.keep[first], sizeof marks);
    if ((marks[0] & marks[1] & marks[2] & marks[3]) == 0x0000000100000001) {
      if (kept == first) {
        kept += kGroup;
      } else {
        moveGroup(first);
      }
      continue;
    }
    for (std::size_t k = first; k < std::min(first + kGroup, size); ++k)
      if (block.keep[k] != 0) move(k);
  }
  return kept;
}

/// Most groups are whole: no call is needed to copy them.
void takeGroup(const float* from, std::size_t count, float* to) {
  if (count == kTaken) {
    std::memcpy(to, from, kTaken * sizeof *to);
  } else {
    std::copy_n(from, count, to);
  }
}

void append(const Block& block, std::size_t kept, EgoPoints& points) {
  const auto end = static_cast<std::ptrdiff_t>(kept);
  points.x.insert(points.x.end(), block.x.begin(), block.x.begin() + end);
  points.y.insert(points.y.end(), block.y.begin(), block.y.begin() + end);
  points.z.insert(points.z.end(), block.z.begin(), block.z.begin() + end);
  points.source.insert(points.source.end(), block.source.begin(), block.source.begin() + end);
}

}  // namespace

EgoPoints usablePoints(const SensorFrame& frame, const PointParams& params) {
  EgoPoints points;
  points.sensor = frame.T_ego_sensor.translation();
  points.reach = params.range_max;
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr || cloud->size() == 0) return points;
  // A scan that is too large is thinned by whole groups of neighbours.
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
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min(kBlock, count - first);
    if (stride == 1) {
      judge(&cloud->x[first], &cloud->y[first], &cloud->z[first], size, rules, block);
    } else {
      for (std::size_t k = 0; k < size; k += kTaken) {
        const std::size_t i = index(first + k), taken = std::min(kTaken, size - k);
        const std::size_t later = std::min(index(first + k + kAhead), cloud->size() - 1);
        for (const auto* axis : {&cloud->x, &cloud->y, &cloud->z})
          __builtin_prefetch(axis->data() + later);
        takeGroup(&cloud->x[i], taken, &block.px[k]);
        takeGroup(&cloud->y[i], taken, &block.py[k]);
        takeGroup(&cloud->z[i], taken, &block.pz[k]);
      }
      judge(block.px.data(), block.py.data(), block.pz.data(), size, rules, block);
    }
    for (std::size_t k = 0; k < size; ++k) points.dropped += block.has_range[k] == 0;
    if (!cloud->label.empty())
      for (std::size_t k = 0; k < size; ++k)
        if (ownProcessingDropsIt(cloud->label[index(first + k)], params.only_objects))
          block.keep[k] = 0;
    if (stride == 1) {
      std::iota(block.source.begin(), block.source.end(), static_cast<std::uint32_t>(first));
    } else {
      for (std::size_t k = 0; k < size; k += kTaken)
        std::iota(&block.source[k], &block.source[k] + std::min(kTaken, size - k),
                  static_cast<std::uint32_t>(index(first + k)));
    }
    append(block, squeeze(block, size), points);
  }
  return points;
}

}  // namespace perception
