#include "libperception/weather/trust/SuspectReturns.h"

#include <algorithm>

#include "libperception/simd/Compress.h"
#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

constexpr std::size_t kBlock = RangeImage::kBlock;

/// Computes heights [m], indices in the cloud, cubes with bins, and marks of near returns.
PERCEPTION_WIDEST void describe(const float* __restrict x, const float* __restrict y,
                                const float* __restrict z, const float* __restrict range,
                                const std::uint32_t* __restrict bin, std::uint32_t first,
                                std::size_t count, const HeightAboveGround above, float far,
                                float* __restrict height, std::uint32_t* __restrict index,
                                std::uint32_t* __restrict cube, std::int32_t* __restrict near) {
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k) {
    height[k] = above.of(x[k], y[k], z[k]);
    index[k] = first + k;
    cube[k] |= bin[k] << SuspectReturns::kBinShift;
    near[k] = (range[k] > 0) & (range[k] <= far);
  }
}

PERCEPTION_WIDEST void markSuspects(const std::uint32_t* __restrict counts, std::size_t count,
                                    std::uint32_t surface, std::int32_t* __restrict marks) {
  for (std::size_t s = 0; s < count; ++s) marks[s] = NeighborCounts(counts[s]).around() < surface;
}

}  // namespace

void SuspectReturns::makeRoom(std::size_t more) {
  const std::size_t least = count + more + kPackSlack;
  if (least <= index.size()) return;
  const std::size_t room = least + least / 2;
  for (auto* numbers : {&index, &pixel, &cube, &corner}) numbers->resize(room);
  for (auto* meters : {&range, &height}) meters->resize(room);
}

void SuspectReturns::makeRoomForResults() {
  if (neighbors.size() == index.size()) return;
  neighbors.resize(index.size());
  for (auto* numbers : {&geometry, &first, &second, &surroundings}) numbers->resize(index.size());
}

void SuspectReturns::add(const LidarCloud& cloud, const RangeImage::Block& block,
                         const std::uint32_t* bins, const HeightAboveGround& height_above,
                         float far, SurroundingCubes& cubes) {
  makeRoom(block.count);
  std::array<float, kBlock> heights;
  std::array<std::uint32_t, kBlock> indices, its_cubes, corners;
  std::array<std::int32_t, kBlock> near;
  const float *x = &cloud.x[block.first], *y = &cloud.y[block.first], *z = &cloud.z[block.first];
  cubes.locate(x, y, z, block.count, its_cubes.data(), corners.data());
  describe(x, y, z, block.ranges, bins, static_cast<std::uint32_t>(block.first), block.count,
           height_above, far, heights.data(), indices.data(), its_cubes.data(), near.data());
  const std::size_t found = pack<6>(near.data(), block.count,
                                    {{{indices.data(), &index[count]},
                                      {block.pixels, &pixel[count]},
                                      {its_cubes.data(), &cube[count]},
                                      {corners.data(), &corner[count]},
                                      {block.ranges, &range[count]},
                                      {heights.data(), &height[count]}}});
  cubes.add(&cube[count], found, (1U << kBinShift) - 1);
  count += found;
}

void SuspectReturns::clearSurfaces(std::uint32_t surface) {
  std::array<std::int32_t, kBlock> marks;
  std::size_t kept = 0;
  for (std::size_t done = 0; done < count; done += kBlock) {
    const std::size_t size = std::min(kBlock, count - done);
    markSuspects(&neighbors[done], size, surface, marks.data());
    kept += pack<6>(marks.data(), size,
                    {{{&index[done], &index[kept]},
                      {&cube[done], &cube[kept]},
                      {&corner[done], &corner[kept]},
                      {&neighbors[done], &neighbors[kept]},
                      {&range[done], &range[kept]},
                      {&height[done], &height[kept]}}});
  }
  count = kept;
}

SuspectReturn SuspectReturns::at(std::size_t s) const {
  const auto share = [](std::uint32_t part, std::uint32_t whole) {
    return whole > 0 ? static_cast<float>(part) / static_cast<float>(whole) : 1.0F;
  };
  const NeighborCounts n(neighbors[s]);
  return {index[s],
          {range[s], static_cast<float>(n.tight()), static_cast<float>(n.wide()),
           share(n.beyond(), n.filled()), height[s], surroundings[s]},
          first[s],
          second[s]};
}

}  // namespace perception
