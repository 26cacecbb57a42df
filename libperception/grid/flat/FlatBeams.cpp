#include "libperception/grid/flat/FlatBeams.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/math/Angle.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr std::size_t kSize = FlatBlock::kSize;

// Marks points that are nearer, or farther, than the current one of their bearing; mostly none.
PERCEPTION_WIDEST void findNearer(const std::int32_t* __restrict bearing,
                                  const float* __restrict range, const float* __restrict nearest,
                                  std::uint8_t* __restrict news) {
  for (std::size_t i = 0; i < kSize; ++i) news[i] = range[i] < nearest[bearing[i]];
}
PERCEPTION_WIDEST void findFarther(const std::int32_t* __restrict bearing,
                                   const float* __restrict range, const float* __restrict farthest,
                                   std::uint8_t* __restrict news) {
  for (std::size_t i = 0; i < kSize; ++i) news[i] = range[i] > farthest[bearing[i]];
}

// Minimum of squares: non-negative floats are ordered like their bits.
PERCEPTION_WIDEST float leastOf(const float* __restrict squares, std::size_t count) {
  std::int32_t least = 0x7F7FFFFF;  // the largest float
  for (std::size_t i = 0; i < count; ++i) {
    std::int32_t bits;
    std::memcpy(&bits, squares + i, sizeof bits);
    least = bits < least ? bits : least;
  }
  float square;
  std::memcpy(&square, &least, sizeof square);
  return square;
}

/// A beam of a block, mirrored so that it increases along.
struct FlatBeam {
  float on, aside, across;  ///< [cells], [cells], [-]
  float from, to;           ///< [cells] along
  std::int32_t column;      ///< of cell and row 0
  std::int32_t step, side;  ///< column increments along and across
  std::int32_t cells;       ///< of the window
};

// Columns that it enters and leaves, several cells along at a time; lanes beyond its end repeat its
// last cell. Returns their number in `way`.
template <class Float>
PERCEPTION_LANES std::int32_t followOne(const FlatBeam& beam, std::int32_t* way) {
  constexpr std::int32_t kCount = LanesOf<Float>::kCount;
  const Float from = all<Float>(beam.from), to = all<Float>(beam.to);
  const auto first = static_cast<std::int32_t>(beam.on + beam.from);
  const auto last = std::min(static_cast<std::int32_t>(beam.on + beam.to), beam.cells - 1);
  const Float end = all<Float>(static_cast<float>(last)), aside = all<Float>(beam.aside);
  const Float on = all<Float>(beam.on), across = all<Float>(beam.across);
  Float next = static_cast<float>(first) + firstLanes<Float>();
  std::int32_t count = 0;
  for (std::int32_t i = first; i <= last; i += kCount, count += 2 * kCount) {
    const Float cell = smaller(next, end);
    const auto along = truncated(cell);
    const Float begin = cell - on;
    const auto row0 = truncated(aside + across * larger(begin, from));
    const auto row1 = truncated(aside + across * smaller(begin + 1, to));
    store8(beam.column + along * beam.step + row0 * beam.side, way + count);
    store8(beam.column + along * beam.step + row1 * beam.side, way + count + kCount);
    next += static_cast<float>(kCount);
  }
  return count;
}

template <class Float>
PERCEPTION_LANES void crossAll(const BeamBlock& b, const WindowPlace& origin, std::int32_t cells,
                               std::int32_t* way, std::uint8_t* crossed) {
  for (std::size_t i = 0; i < b.count; ++i) {
    if (!(b.from[i] < b.to[i])) continue;
    const bool along_x = b.face[i] < 2, back = b.face[i] % 2 != 0;
    const float on = along_x ? origin.x : origin.y;
    const std::int32_t step = along_x ? 1 : cells;
    const std::int32_t count =
        followOne<Float>({back ? static_cast<float>(cells) - on : on, along_x ? origin.y : origin.x,
                          b.across[i], b.from[i], b.to[i], back ? (cells - 1) * step : 0,
                          back ? -step : step, along_x ? cells : 1, cells},
                         way);
    for (std::int32_t k = 0; k < count; k += kLanes)
      for (std::int32_t j = k; j < k + kLanes; ++j) crossed[static_cast<std::uint32_t>(way[j])] = 1;
  }
}

// Like PERCEPTION_WIDER, with vectors of the width of each target.
PERCEPTION_TARGET("default")
void crossBeams(const BeamBlock& b, const WindowPlace& origin, std::int32_t cells,
                std::int32_t* way, std::uint8_t* crossed) {
  crossAll<Float4>(b, origin, cells, way, crossed);
}
#if PERCEPTION_HAS_WIDER
PERCEPTION_TARGET("avx2")
void crossBeams(const BeamBlock& b, const WindowPlace& origin, std::int32_t cells,
                std::int32_t* way, std::uint8_t* crossed) {
  crossAll<Float8>(b, origin, cells, way, crossed);
}
#endif

}  // namespace

FlatBeams::FlatBeams(double step, int cells)
    : cells_(cells), way_(static_cast<std::size_t>(2 * (cells + kLanes))) {
  const auto bearings = static_cast<std::size_t>(std::ceil(kTwoPi / step));
  bearing_bins_.per_radian = static_cast<float>(static_cast<double>(bearings) / kTwoPi);
  bearing_bins_.count = static_cast<std::int32_t>(bearings);
  nearest_.resize(bearings + 1), farthest_.resize(bearings + 1);
  stops_.resize(bearings + 1), ends_.resize(bearings + 1);
}

void FlatBeams::begin(const WindowPlace& origin) {
  std::fill(nearest_.begin(), nearest_.end(), kNone);
  std::fill(farthest_.begin(), farthest_.end(), 0.0F);
  origin_ = origin, origin_.z = kMiddle, origin_.low = origin_.high = 1;
  bearing_bins_.x = origin.x, bearing_bins_.y = origin.y;
}

void FlatBeams::offerHits(const FlatBlock& hits, std::size_t first) {
  std::uint8_t marks[kSize];
  findNearer(hits.bearing.data(), hits.stop.data(), nearest_.data(), marks);
  relevant_.find(marks, kSize);
  for (const std::size_t k : relevant_) {
    const auto bearing = static_cast<std::size_t>(hits.bearing[k]);
    const bool nearer = hits.stop[k] < nearest_[bearing];
    nearest_[bearing] = nearer ? hits.stop[k] : nearest_[bearing];
    stops_[bearing] = nearer ? static_cast<std::uint32_t>(first + k) : stops_[bearing];
  }
  if (hits.passes)
    offerPassing(hits.bearing.data(), hits.pass.data(), static_cast<std::uint32_t>(first));
}

void FlatBeams::offerPassing(const std::int32_t* bearings, const float* ranges,
                             std::uint32_t first) {
  std::uint8_t marks[kSize];
  findFarther(bearings, ranges, farthest_.data(), marks);
  relevant_.find(marks, kSize);
  for (const std::size_t k : relevant_) {
    const auto bearing = static_cast<std::size_t>(bearings[k]);
    if (ranges[k] > farthest_[bearing])
      farthest_[bearing] = ranges[k], ends_[bearing] = first + static_cast<std::uint32_t>(k);
  }
}

// Stopped beams need no further points. Most others are ground returns nearer than the farthest
// point of their bearing: whole blocks of them are skipped.
std::size_t FlatBeams::offerClear(const GridPoints& points, const WindowFrame& frame) {
  for (std::size_t i = 0; i < nearest_.size(); ++i)
    if (nearest_[i] < kNone) farthest_[i] = kNone;
  const PointOffset from = frame.offsetOf(points);
  std::size_t not_finite = 0;
  findLeast();
  for (std::size_t first = 0; first < points.size(); first += kSize) {
    const std::size_t count = std::min(kSize, points.size() - first);
    if (count == kSize && isRedundant(surveyClear(points, first, from, bearing_bins_))) continue;
    clear_.place(points, first, count, from, bearing_bins_);
    not_finite += clear_.not_finite;
    offerPassing(clear_.bearing.data(), clear_.range.data(),
                 kClear | static_cast<std::uint32_t>(first));
    if (relevant_.size() > 0) findLeast();
  }
  return not_finite;
}

bool FlatBeams::isRedundant(const ClearSurvey& survey) const {
  if (!survey.all_finite) return false;
  for (std::size_t q = 0; q < kQuadrants; ++q)
    if (survey.quadrants >> q & 1U && !(survey.farthest <= least_[q])) return false;
  return true;
}

// Bearings begin at -x, counter-clockwise; neighbors of a quadrant are included because of
// rounding.
void FlatBeams::findLeast() {
  constexpr std::array<std::size_t, kQuadrants> kByTurn = {3, 2, 0, 1};
  constexpr std::size_t kBeside = 2;
  const std::size_t bearings = farthest_.size() - 1;
  for (std::size_t turn = 0; turn < kQuadrants; ++turn) {
    const std::size_t begin = turn * bearings / kQuadrants;
    const std::size_t end = ((turn + 1) * bearings + kQuadrants - 1) / kQuadrants;
    float least = leastOf(&farthest_[begin], end - begin);
    for (std::size_t k = 1; k <= kBeside; ++k)
      least = std::min({least, farthest_[(begin + bearings - k) % bearings],
                        farthest_[(end + k - 1) % bearings]});
    least_[kByTurn[turn]] = least;
  }
}

std::size_t FlatBeams::cross(const GridPoints& hits, const GridPoints& clear,
                             const WindowFrame& frame, std::uint8_t* crossed) {
  const PointOffset of_hits = frame.offsetOf(hits), of_clear = frame.offsetOf(clear);
  std::size_t beams = 0;
  for (std::size_t bearing = 0; bearing + 1 < nearest_.size(); ++bearing) {
    const bool stopped = nearest_[bearing] < kNone;
    if (!stopped && !(farthest_[bearing] > 0)) continue;
    const std::uint32_t end = stopped ? stops_[bearing] : ends_[bearing];
    const bool is_clear = (end & kClear) != 0;
    const PointOffset& from = is_clear ? of_clear : of_hits;
    const GridPoints& points = is_clear ? clear : hits;
    const std::size_t i = end & ~kClear;
    // Heights are not used in the plane.
    block_.add({*points.x(i) * from.per_meter + from.x, *points.y(i) * from.per_meter + from.y,
                kMiddle, 1, 1});
    ++beams;
    if (block_.count == BeamBlock::kSize) crossBlock(crossed);
  }
  crossBlock(crossed);
  return beams;
}

void FlatBeams::crossBlock(std::uint8_t* crossed) {
  block_.prepare(origin_, cells_, 1, {});
  crossBeams(block_, origin_, cells_, way_.data(), crossed);
  block_.count = 0;
}

}  // namespace perception
