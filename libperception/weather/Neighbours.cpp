#include "libperception/weather/Neighbours.h"

#include <algorithm>
#include <array>

#include "libperception/core/Lanes.h"
#include "libperception/core/Wider.h"

namespace perception {
namespace {

constexpr float kTightFloor = 0.03F;  // [m] noise of a range
constexpr float kBeyondFloor = 0.3F;  // [m]
constexpr std::size_t kBlock = 1024;  // returns whose places stay in the nearest cache

/// A range image as loops want it.
struct Picture {
  const float* ranges;          ///< [m] of each return
  const std::uint32_t* pixels;  ///< of each return
  const float* image;           ///< [m]
  std::ptrdiff_t stride;
};

PERCEPTION_LANES std::uint32_t sumOf(const Int8& v) {
  using Int4 = std::int32_t __attribute__((vector_size(16)));
  Int4 halves[2];
  std::memcpy(halves, &v, sizeof halves);
  const Int4 sums = halves[0] + halves[1];
  return static_cast<std::uint32_t>((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

/// About the pixel at `corner`: rows of eight and a ninth column apart.
PERCEPTION_LANES NeighbourCounts countAbout(const float* corner, std::ptrdiff_t stride, float r,
                                            const NeighbourRules& rules) {
  static_assert(RangeImage::kColumnReach == 4 && RangeImage::kRowReach == 2, "nine by five");
  constexpr int kMiddle = RangeImage::kColumnReach, kBits = NeighbourCounts::kBits;
  const float tight = rules.tight * r + kTightFloor, wide = rules.wide * r + kTightFloor;
  const float behind = (1 + rules.beyond) * r + kBeyondFloor;
  Int8 near = eight(0), neighbours = eight(0), beyond = eight(0), filled = eight(0);
  Int8 around = eight(0);
  const auto look = [&](const Float8& other) {  // downwards: true is -1
    const Float8 off = magnitude(other - r);
    const Int8 same = off < tight;
    near += same, neighbours += off < wide;
    beyond += other > behind, filled += other > 0;
    return same;
  };
  Float8 ninth = eight(0.0F);
  for (int row = 0; row < 5; ++row, corner += stride) {
    Float8 line = load8(corner);
    if (row == 2) line[kMiddle] = 0;  // the return itself
    const Int8 same = look(line);
    if (row >= 1 && row <= 3) around += same;
    ninth[row] = corner[kLanes];
  }
  look(ninth);
  around &= Int8{0, 0, 0, -1, -1, -1, 0, 0};
  const Int8 all = near + (neighbours << kBits) + (beyond << 2 * kBits) + (filled << 3 * kBits) +
                   (around << 4 * kBits);
  return NeighbourCounts(0U - sumOf(all));
}

/// The suspects among `count` returns from `first` on, and their number. Written without a branch:
/// what is none is overwritten by the next.
PERCEPTION_WIDER std::size_t suspectsAmong(const Picture picture, const NeighbourRules rules,
                                           std::size_t first, std::size_t count,
                                           std::uint32_t* suspects, NeighbourCounts* counts) {
  std::array<std::uint32_t, kBlock> near, is_near;
  const float* ranges = picture.ranges + first;
  for (std::size_t k = 0; k < count; ++k) is_near[k] = (ranges[k] > 0) & (ranges[k] <= rules.far);
  std::size_t near_count = 0, found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    near[near_count] = static_cast<std::uint32_t>(first + k);
    near_count += is_near[k];
  }
  const float* corner =
      picture.image - RangeImage::kRowReach * picture.stride - RangeImage::kColumnReach;
  for (std::size_t k = 0; k < near_count; ++k) {
    const std::uint32_t i = near[k];
    suspects[found] = i;
    counts[found] =
        countAbout(corner + picture.pixels[i], picture.stride, picture.ranges[i], rules);
    found += counts[found].around() < static_cast<std::uint32_t>(rules.surface);
  }
  return found;
}

}  // namespace

std::size_t findSuspects(const RangeImage& image, const NeighbourRules& rules,
                         std::uint32_t* suspects, NeighbourCounts* counts) {
  const Picture picture{image.ranges().data(), image.pixelsOfReturns().data(),
                        image.pixels().data(), image.stride()};
  const std::size_t returns = image.ranges().size();
  std::size_t found = 0;
  for (std::size_t first = 0; first < returns; first += kBlock)
    found += suspectsAmong(picture, rules, first, std::min(kBlock, returns - first),
                           suspects + found, counts + found);
  return found;
}

}  // namespace perception
