#include "libperception/weather/trust/Neighbors.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "libperception/simd/Compress.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr float kTightFloor = 0.03F;  // [m] noise of a range
constexpr float kBeyondFloor = 0.3F;  // [m]

/// Differences of range within which a neighbor counts.
struct Bounds {
  Float8 tight, wide, behind;  ///< [m]
};
PERCEPTION_LANES Bounds boundsAt(const Float8& r, const NeighborRules& rules) {
  return {rules.tight * r + kTightFloor, rules.wide * r + kTightFloor,
          (1 + rules.beyond) * r + kBeyondFloor};
}

/// Eight lanes of each count, negated: true is -1.
struct Tally {
  Int8 near = eight(0), neighbors = eight(0), beyond = eight(0), filled = eight(0);
  Int8 around = eight(0);

  /// Adds neighbors to the counts; returns which are within `tight`.
  PERCEPTION_LANES Int8 look(const Float8& other, const Float8& r, const Bounds& bounds) {
    const Float8 off = magnitude(other - r);
    const Int8 same = off < bounds.tight;
    near += same, neighbors += off < bounds.wide;
    beyond += other > bounds.behind, filled += other > 0;
    return same;
  }
  /// The bits of NeighborCounts, negated.
  PERCEPTION_LANES Int8 bits() const {
    constexpr int kBits = NeighborCounts::kBits;
    return near + (neighbors << kBits) + (beyond << 2 * kBits) + (filled << 3 * kBits) +
           (around << 4 * kBits);
  }
};

PERCEPTION_LANES std::uint32_t sumOf(const Int8& v) {
  using Int4 = std::int32_t __attribute__((vector_size(16)));
  Int4 halves[2];
  std::memcpy(halves, &v, sizeof halves);
  const Int4 sums = halves[0] + halves[1];
  return static_cast<std::uint32_t>((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

/// Counts about one pixel, from `corner` of its neighborhood: rows of eight, the ninth column
/// separately.
PERCEPTION_LANES std::uint32_t countAbout(const float* corner, std::ptrdiff_t stride, float range,
                                          const NeighborRules& rules) {
  static_assert(RangeImage::kColumnReach == 4 && RangeImage::kRowReach == 2, "nine by five");
  constexpr int kMiddle = RangeImage::kColumnReach;
  const Float8 r = eight(range);
  const Bounds bounds = boundsAt(r, rules);
  Tally tally;
  Float8 ninth = eight(0.0F);
  for (int row = 0; row < 5; ++row, corner += stride) {
    Float8 line = load8(corner);
    if (row == 2) line[kMiddle] = 0;  // the return itself
    const Int8 same = tally.look(line, r, bounds);
    if (row >= 1 && row <= 3) tally.around += same;
    ninth[row] = corner[kLanes];
  }
  tally.look(ninth, r, bounds);
  tally.around &= Int8{0, 0, 0, -1, -1, -1, 0, 0};
  return 0U - sumOf(tally.bits());
}

PERCEPTION_WIDER void countAll(const float* image, std::ptrdiff_t stride, const NeighborRules rules,
                               const std::uint32_t* pixels, const float* ranges, std::size_t count,
                               std::uint32_t* counts) {
  const float* corner = image - RangeImage::kRowReach * stride - RangeImage::kColumnReach;
  for (std::size_t k = 0; k < count; ++k)
    counts[k] = countAbout(corner + pixels[k], stride, ranges[k], rules);
}

PERCEPTION_LANES bool anyOf(const Int8& marks) {
  std::uint64_t pairs[kLanes / 2];
  std::memcpy(pairs, &marks, sizeof pairs);
  return (pairs[0] | pairs[1] | pairs[2] | pairs[3]) != 0;
}

/// Counts about each pixel of a row with a near return, for eight pixels at once.
PERCEPTION_WIDER void countRow(const float* line, std::ptrdiff_t stride, std::size_t columns,
                               const NeighborRules rules, std::uint32_t* counts) {
  constexpr int kAside = RangeImage::kColumnReach, kAway = RangeImage::kRowReach;
  for (std::size_t c = 0; c < columns; c += kLanes) {
    const Float8 r = load8(line + c);
    if (!anyOf((r > 0) & (r <= rules.far))) continue;
    const Bounds bounds = boundsAt(r, rules);
    Tally tally;
    for (int row = -kAway; row <= kAway; ++row) {
      const float* middle = line + c + row * stride;
      for (int aside = -kAside; aside <= kAside; ++aside) {
        if (row == 0 && aside == 0) continue;
        const Int8 same = tally.look(load8(middle + aside), r, bounds);
        if (row >= -1 && row <= 1 && aside >= -1 && aside <= 1) tally.around += same;
      }
    }
    store8(-tally.bits(), counts + c);
  }
}

}  // namespace

namespace {

/// Copies the counts of returns held by the image and marks the hidden ones.
PERCEPTION_WIDER void lookUp(const float* __restrict shown, const std::uint32_t* __restrict counts,
                             const std::uint32_t* __restrict pixel, const float* __restrict range,
                             std::size_t count, std::uint32_t* __restrict of_return,
                             std::int32_t* __restrict hidden) {
  for (std::size_t k = 0; k < count; ++k) {
    const auto place = static_cast<std::int32_t>(pixel[k]);
    of_return[k] = counts[place];
    hidden[k] = shown[place] != range[k];
  }
}

}  // namespace

/// Indices of the hidden returns; returns how many they are.
std::size_t NeighborCounter::findHidden(const RangeImage& image, SuspectReturns& near) {
  constexpr std::size_t kBlock = RangeImage::kBlock;
  std::array<std::int32_t, kBlock> marks;
  std::size_t hidden = 0;
  for (std::size_t first = 0; first < near.count; first += kBlock) {
    const std::size_t size = std::min(kBlock, near.count - first);
    lookUp(image.pixels().data(), of_pixel_.data(), &near.pixel[first], &near.range[first], size,
           &near.neighbors[first], marks.data());
    hidden += packPlaces(marks.data(), size, static_cast<std::uint32_t>(first), &hidden_[hidden]);
  }
  return hidden;
}

/// Deduplicates hidden returns of equal pixel and range ("kinds"); returns the number of kinds.
/// Duplicates are some dozen returns apart, so a small direct-mapped table finds most; missed ones
/// are only counted twice. Branch-free: an entry that is no new kind is overwritten by the next.
std::size_t NeighborCounter::deduplicateReturns(std::size_t hidden, const SuspectReturns& near) {
  constexpr std::uint32_t kTable = 4096;
  std::array<std::uint32_t, kTable> last_kind{};
  const std::uint32_t* __restrict pixels = near.pixel.data();
  const float* __restrict ranges = near.range.data();
  std::uint32_t* __restrict kind_pixel = kind_pixel_.data(), * __restrict kind = kind_.data();
  float* __restrict kind_range = kind_range_.data();
  std::uint32_t kinds = 0;
  kind_pixel[0] = 0;  // matches no return
  for (std::size_t h = 0; h < hidden; ++h) {
    const std::uint32_t pixel = pixels[hidden_[h]];
    const float range = ranges[hidden_[h]];
    const std::uint32_t last = last_kind[pixel % kTable];
    const bool known = (kind_pixel[last] == pixel) & (kind_range[last] == range);
    kinds += !known;
    const std::uint32_t its = known ? last : kinds;
    kind_pixel[kinds] = known ? kind_pixel[kinds] : pixel;
    kind_range[kinds] = known ? kind_range[kinds] : range;
    kind[h] = last_kind[pixel % kTable] = its;
  }
  return kinds + 1;
}

void NeighborCounter::count(const RangeImage& image, const NeighborRules& rules,
                            SuspectReturns& near) {
  const std::size_t room = near.index.size() + 1;
  of_pixel_.resize(image.pixels().size());
  hidden_.resize(room), kind_.resize(room);
  kind_pixel_.resize(room), kind_range_.resize(room), of_kind_.resize(room);
  for (std::size_t row = image.lowestRow(); row <= image.highestRow(); ++row) {
    const std::size_t first = row * static_cast<std::size_t>(image.stride()) +
                              RangeImage::kColumnReach + image.firstColumn();
    countRow(&image.pixels()[first], image.stride(), image.lastColumn() + 1 - image.firstColumn(),
             rules, &of_pixel_[first]);
  }
  const std::size_t hidden = findHidden(image, near), kinds = deduplicateReturns(hidden, near);
  countAll(image.pixels().data(), image.stride(), rules, &kind_pixel_[1], &kind_range_[1],
           kinds - 1, &of_kind_[1]);
  for (std::size_t h = 0; h < hidden; ++h) near.neighbors[hidden_[h]] = of_kind_[kind_[h]];
}

std::size_t NeighborCounter::memoryBytes() const {
  return sizeof(std::uint32_t) *
         (of_pixel_.capacity() + hidden_.capacity() + kind_.capacity() + kind_pixel_.capacity() +
          kind_range_.capacity() + of_kind_.capacity());
}

}  // namespace perception
