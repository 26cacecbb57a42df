#include "libperception/grid/flat/FlatBlock.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/simd/Dispatch.h"
#include "libperception/simd/FastAtan2.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr float kTrustedEnd = 0.5F;  // a hit of lower weight does not stop its beam

// Points in the sensor's cell get the bin behind the last one.
PERCEPTION_LANES std::int32_t bearingOf(float dx, float dy, float range2, const BearingBins& bins) {
  const auto bin = static_cast<std::int32_t>((fastAtan2(dx, dy) + 3.1416F) * bins.per_radian);
  const std::int32_t bounded = bin < bins.count ? bin : 0;
  return range2 > 1 ? bounded : bins.count;
}

PERCEPTION_LANES std::int32_t bitsOf(float v) {
  std::int32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}

/// Coordinates [m] of the points of a block, relative to their base.
struct BlockPoints {
  const float *x, *y, *z;
  std::size_t count;
};

struct BlockCounts {
  std::int32_t hits, beside;  // `beside`: outside the slab
  std::int32_t not_finite;    // non-zero when some points are not finite
};

PERCEPTION_WIDEST BlockCounts placeHits(const BlockPoints points, const PointOffset from,
                                        const WindowRules k, const BearingBins bins,
                                        FlatBlock& __restrict out) {
  const float* __restrict xs = points.x, * __restrict ys = points.y, * __restrict zs = points.z;
  const auto row = static_cast<std::int32_t>(k.cells);
  const std::int32_t behind = row * row;
  BlockCounts counts{0, 0, 0};
  for (std::size_t i = 0; i < points.count; ++i) {
    const float x = xs[i] * from.per_meter + from.x;
    const float y = ys[i] * from.per_meter + from.y;
    const float z = zs[i] * from.per_meter + from.z;
    const float above = k.slope_x * x + k.slope_y * y + k.slope_z * z + k.offset;
    const float cx = x - k.center_x, cy = y - k.center_y;
    const float wider = k.grade * std::sqrt(cx * cx + cy * cy);
    const float over = above - k.z_min + wider, under = k.z_max + wider - above;
    const std::int32_t in_slab = (over >= 0) & (under >= 0);
    const std::int32_t marks = in_slab & (x >= 0) & (y >= 0) & (x < k.cells) & (y < k.cells);
    const float kx = marks != 0 ? x : 0, ky = marks != 0 ? y : 0;
    const std::int32_t column = static_cast<std::int32_t>(ky) * row + static_cast<std::int32_t>(kx);
    out.column[i] = marks != 0 ? column : behind;
    const float sum = x + y + z;
    const float dx = x - bins.x, dy = y - bins.y, range2 = dx * dx + dy * dy;
    out.bearing[i] = bearingOf(dx, dy, range2, bins);
    out.range[i] = range2, out.stop[i] = in_slab != 0 ? range2 : FlatBlock::kNone;
    counts.hits += marks, counts.beside += 1 - in_slab;
    counts.not_finite |= bitsOf(sum - sum);  // zero for finite values
  }
  return counts;
}

// Separates hits that stop their beams from those that do not. Returns whether some do not.
PERCEPTION_WIDEST std::int32_t weigh(const float* __restrict weights, std::size_t count,
                                     FlatBlock& __restrict out) {
  std::int32_t passes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float given = weights[i], stop = out.stop[i];
    const float w = given < PlacedBlock::kFullWeight ? given : 1;  // NaN counts as 1
    const float share = w > 0 ? w : 0;
    out.mark[i] = static_cast<std::int32_t>(share * FlatBlock::kWhole + 0.5F);
    const float stops = w >= kTrustedEnd ? stop : FlatBlock::kNone;
    out.stop[i] = stops;
    passes |= stops >= FlatBlock::kNone;
  }
  return passes;
}

PERCEPTION_WIDEST void findPassing(FlatBlock& out) {
  for (std::size_t i = 0; i < FlatBlock::kSize; ++i) {
    const float range2 = out.range[i];
    out.pass[i] = out.stop[i] < FlatBlock::kNone ? 0 : range2;
  }
}

// Gives points that are not finite the bin behind the last one. Returns how many they are.
std::size_t dropNotFinite(const BlockPoints& points, const BearingBins& bins,
                          std::int32_t* bearing) {
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float sum = points.x[i] + points.y[i] + points.z[i];
    if (sum - sum == 0) continue;
    bearing[i] = bins.count, ++dropped;
  }
  return dropped;
}

// Bearing and range of points that only clear. Returns non-zero when some are not finite.
PERCEPTION_WIDEST std::int32_t placeClear(const BlockPoints points, const PointOffset from,
                                          const BearingBins bins, std::int32_t* __restrict bearing,
                                          float* __restrict range) {
  const float* __restrict xs = points.x, * __restrict ys = points.y, * __restrict zs = points.z;
  std::int32_t not_finite = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float dx = xs[i] * from.per_meter + from.x - bins.x;
    const float dy = ys[i] * from.per_meter + from.y - bins.y;
    const float sum = xs[i] + ys[i] + zs[i], range2 = dx * dx + dy * dy;
    bearing[i] = bearingOf(dx, dy, range2, bins);
    range[i] = range2, not_finite |= bitsOf(sum - sum);
  }
  return not_finite;
}

struct SurveyBits {
  std::int32_t farthest, any_x, any_y, all_x, all_y, not_finite;
};

// Squares are non-negative, hence ordered like their bits; NaN is above all.
PERCEPTION_WIDEST void survey(const float* __restrict xs, const float* __restrict ys,
                              const float* __restrict zs, const PointOffset from,
                              const BearingBins bins, SurveyBits& out) {
  SurveyBits s{0, 0, 0, -1, -1, 0};
  for (std::size_t i = 0; i < ClearBlock::kSize; ++i) {
    const float dx = xs[i] * from.per_meter + from.x - bins.x;
    const float dy = ys[i] * from.per_meter + from.y - bins.y;
    const float sum = xs[i] + ys[i] + zs[i];
    const std::int32_t range = bitsOf(dx * dx + dy * dy) & 0x7FFFFFFF;
    s.farthest = range > s.farthest ? range : s.farthest;
    s.any_x |= bitsOf(dx), s.any_y |= bitsOf(dy);
    s.all_x &= bitsOf(dx), s.all_y &= bitsOf(dy);
    s.not_finite |= bitsOf(sum - sum);
  }
  out = s;
}

}  // namespace

void FlatBlock::place(const GridPoints& points, const float* weights, std::size_t first,
                      std::size_t count, const WindowFrame& frame, const BearingBins& bins) {
  const BlockPoints block{points.x(first), points.y(first), points.z(first), count};
  const BlockCounts counts = placeHits(block, frame.offsetOf(points), frame.rules(), bins, *this);
  const std::int32_t passing = weights ? weigh(weights, count, *this) : counts.beside;
  hits = static_cast<std::size_t>(counts.hits), passes = passing != 0;
  not_finite = counts.not_finite != 0 ? dropNotFinite(block, bins, bearing.data()) : 0;
  const auto row = static_cast<std::int32_t>(frame.rules().cells);
  for (std::size_t i = count; i < kSize; ++i) {
    column[i] = row * row, mark[i] = 0;
    bearing[i] = bins.count, range[i] = 0, stop[i] = kNone;
  }
  if (passes) findPassing(*this);
}

// Interleaved, since neighboring hits often mark the same column.
void FlatBlock::markColumns(bool weighted, std::uint8_t* weights) const {
  if (!weighted) {
    for (const std::int32_t i : column) weights[i] = kWhole;
    return;
  }
  constexpr std::size_t kStreams = 4, kApart = kSize / kStreams;
  for (std::size_t i = 0; i < kApart; ++i)
    for (std::size_t k = i; k < kSize; k += kApart) {
      std::uint8_t& weight = weights[column[k]];
      weight = std::max(weight, static_cast<std::uint8_t>(mark[k]));
    }
}

void ClearBlock::place(const GridPoints& points, std::size_t first, std::size_t count,
                       PointOffset from, const BearingBins& bins) {
  const BlockPoints block{points.x(first), points.y(first), points.z(first), count};
  const std::int32_t some = placeClear(block, from, bins, bearing.data(), range.data());
  not_finite = some != 0 ? dropNotFinite(block, bins, bearing.data()) : 0;
  for (std::size_t i = count; i < kSize; ++i) bearing[i] = bins.count, range[i] = 0;
}

ClearSurvey surveyClear(const GridPoints& points, std::size_t first, PointOffset from,
                        const BearingBins& bins) {
  SurveyBits bits{};
  survey(points.x(first), points.y(first), points.z(first), from, bins, bits);
  ClearSurvey out;
  std::memcpy(&out.farthest, &bits.farthest, sizeof out.farthest);
  const unsigned falls_x = bits.any_x < 0, rises_x = bits.all_x >= 0;
  const unsigned falls_y = bits.any_y < 0, rises_y = bits.all_y >= 0;
  const unsigned along_x = rises_x | falls_x << 1U;
  out.quadrants = along_x * rises_y | along_x * falls_y << 2U;
  out.all_finite = bits.not_finite == 0;
  return out;
}

}  // namespace perception
