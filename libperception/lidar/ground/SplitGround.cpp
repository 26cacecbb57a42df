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

/// Unmarks returns that the sensor labels as ground, and phantoms.
void unmark(const LidarCloud& cloud, const std::uint32_t* source, std::size_t count,
            float least_trust, std::int32_t* marks) {
  constexpr auto kGround = static_cast<std::uint8_t>(PointLabel::kGround);
  if (!cloud.label.empty())
    for (std::size_t k = 0; k < count; ++k) marks[k] &= cloud.label[source[k]] != kGround;
  if (cloud.trust.size() == cloud.size())
    for (std::size_t k = 0; k < count; ++k) marks[k] &= !(cloud.trust[source[k]] < least_trust);
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
  std::array<std::int32_t, kSplitBlock> marks;
  std::size_t found = 0;
  for (std::size_t first = 0; first < heights.size(); first += kSplitBlock) {
    const std::size_t count = std::min(kSplitBlock, heights.size() - first);
    markObstacles(&heights[first], count, low, high, marks.data());
    unmark(cloud, &points.source[first], count, least_trust, marks.data());
    obstacles.resize(found + count + kPackSlack);
    found += packPlaces(marks.data(), count, static_cast<std::uint32_t>(first), &obstacles[found]);
  }
  obstacles.resize(found);
}

std::vector<std::uint32_t> heightsBetween(const std::vector<float>& heights, float low,
                                          float high) {
  std::vector<std::uint32_t> between;
  std::array<std::int32_t, kSplitBlock> marks;
  std::array<std::uint32_t, kSplitBlock + kPackSlack> places;
  for (std::size_t first = 0; first < heights.size(); first += kSplitBlock) {
    const std::size_t count = std::min(kSplitBlock, heights.size() - first);
    markObstacles(&heights[first], count, low, high, marks.data());
    const std::size_t found =
        packPlaces(marks.data(), count, static_cast<std::uint32_t>(first), places.data());
    between.insert(between.end(), places.begin(),
                   places.begin() + static_cast<std::ptrdiff_t>(found));
  }
  return between;
}

}  // namespace perception
