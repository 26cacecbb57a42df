#include "libperception/lidar/ground/SplitGround.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "libperception/simd/Compress.h"

namespace perception {
namespace {

constexpr std::size_t kSplitBlock = 1024;  // points that fit in the L1 cache

PERCEPTION_WIDEST void markGround(const float* __restrict heights, std::size_t count, float low,
                                  std::uint8_t* __restrict marks) {
  for (std::size_t k = 0; k < count; ++k) marks[k] = std::abs(heights[k]) <= low;
}

PERCEPTION_WIDEST void markObstacles(const float* __restrict heights, std::size_t count, float low,
                                     float high, std::int32_t* __restrict marks) {
  for (std::size_t k = 0; k < count; ++k) marks[k] = (heights[k] > low) & (heights[k] < high);
}

/// Marks the parts of a block: `others` are those that count and are no obstacles.
PERCEPTION_WIDEST void markParts(const float* __restrict x, const float* __restrict y,
                                 const float* __restrict heights, std::size_t count,
                                 const SlabRules rules, std::int32_t* __restrict obstacles,
                                 std::int32_t* __restrict others, std::int32_t* __restrict road) {
  for (std::size_t k = 0; k < count; ++k) {
    const float h = heights[k];
    const std::int32_t counts =
        (h > rules.mirrored) & (rules.travel * x[k] >= rules.least_forward * std::abs(y[k]));
    const std::int32_t within = (h > rules.low) & (h < rules.high);
    obstacles[k] = counts & within, others[k] = counts & (within ^ 1);
    road[k] = counts & (h < rules.road_to);
  }
}

/// Unmarks returns that the sensor labels as ground, and phantoms.
void unmark(const LidarCloud& cloud, const std::uint32_t* source, std::size_t count,
            float least_trust, std::int32_t* marks) {
  constexpr auto kGround = static_cast<std::uint8_t>(PointLabel::kGround);
  if (!cloud.label.empty())
    for (std::size_t k = 0; k < count; ++k) marks[k] &= cloud.label[source[k]] != kGround;
  if (cloud.trust.size() == cloud.size())
    for (std::size_t k = 0; k < count; ++k) marks[k] &= !(cloud.trust[source[k]] < least_trust);
}

/// Indices of heights between two; `unmark` may unmark those of each block.
template <class Unmark>
std::vector<std::uint32_t> between(const std::vector<float>& heights, float low, float high,
                                   const Unmark& unmark) {
  std::vector<std::uint32_t> found;
  found.reserve(heights.size());
  std::array<std::int32_t, kSplitBlock> marks;
  std::array<std::uint32_t, kSplitBlock + kPackSlack> places;
  for (std::size_t first = 0; first < heights.size(); first += kSplitBlock) {
    const std::size_t count = std::min(kSplitBlock, heights.size() - first);
    markObstacles(&heights[first], count, low, high, marks.data());
    unmark(first, count, marks.data());
    const std::size_t marked =
        packPlaces(marks.data(), count, static_cast<std::uint32_t>(first), places.data());
    found.insert(found.end(), places.begin(), places.begin() + static_cast<std::ptrdiff_t>(marked));
  }
  return found;
}

}  // namespace

void labelGround(const EgoPoints& points, const std::vector<float>& heights, float low,
                 std::size_t returns, std::vector<std::uint8_t>& ground) {
  ground.assign(returns, 0);
  std::array<std::uint8_t, kSplitBlock> marks;
  for (std::size_t first = 0; first < heights.size(); first += kSplitBlock) {
    const std::size_t count = std::min(kSplitBlock, heights.size() - first);
    const std::uint32_t* source = &points.source[first];
    markGround(&heights[first], count, low, marks.data());
    if (source[count - 1] - source[0] == count - 1) {  // contiguous, the common case
      std::memcpy(&ground[source[0]], marks.data(), count);
    } else {
      for (std::size_t k = 0; k < count; ++k) ground[source[k]] = marks[k];
    }
  }
}

void splitGround(const LidarCloud& cloud, const EgoPoints& points,
                 const std::vector<float>& heights, const SplitRules& rules,
                 std::vector<std::uint8_t>& ground, std::vector<std::uint32_t>& obstacles) {
  const auto low = static_cast<float>(rules.height_min),
             high = static_cast<float>(rules.height_max),
             least_trust = static_cast<float>(rules.min_trust);
  labelGround(points, heights, low, cloud.size(), ground);
  if (!cloud.label.empty())
    for (const std::uint32_t i : points.source)
      ground[i] |= cloud.label[i] == static_cast<std::uint8_t>(PointLabel::kGround);
  obstacles = between(heights, low, high, [&](std::size_t first, std::size_t count, auto* marks) {
    unmark(cloud, &points.source[first], count, least_trust, marks);
  });
}

void SlabParts::find(const float* x, const float* y, const float* heights, std::size_t count,
                     const SlabRules& rules) {
  std::array<std::int32_t, kSize> is_obstacle, is_other, is_road;
  markParts(x, y, heights, count, rules, is_obstacle.data(), is_other.data(), is_road.data());
  obstacles.count = packPlaces(is_obstacle.data(), count, 0, obstacles.index.data());
  others.count = packPlaces(is_other.data(), count, 0, others.index.data());
  road.count = packPlaces(is_road.data(), count, 0, road.index.data());
}

std::vector<std::uint32_t> heightsBetween(const std::vector<float>& heights, float low,
                                          float high) {
  return between(heights, low, high, [](std::size_t, std::size_t, auto*) {});
}

}  // namespace perception
