#include "libperception/grid/beams/BeamFans.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/grid/beams/LayerBits.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"
#if PERCEPTION_HAS_WIDER
#include <immintrin.h>
#endif

namespace perception {
namespace {

// [cells] width of a fan at the window's far end. Plus the cell by which a beam may move across per
// cell along, this is below two, so that three rows contain it.
constexpr float kWidest = 0.9F;
constexpr int kRows = 3;
constexpr float kFarthest = 7000;      // [cells] largest window: fan numbers have 16 bits
constexpr float kLevelSlope = 1e-20F;  // [-] replaces a slope of zero

/// Common data of the beams of a fan, mirrored so that they increase along and across.
struct Fan {
  float along, aside, height;  ///< [cells] of the sensor
  float slope;                 ///< [-] least slope of its beams
  std::int32_t first, last;    ///< cells along, `first` of a group
  std::int32_t cells;          ///< of the window
  std::int32_t column;         ///< of cell and row 0
  std::int32_t step, side;     ///< column increments along and across
};

/// Whether a lane is not 0 but -1.
PERCEPTION_LANES bool anyLane(const Int4& v) {
  std::uint64_t pairs[2];
  std::memcpy(pairs, &v, sizeof pairs);
  return (pairs[0] | pairs[1]) != 0;
}
PERCEPTION_LANES bool anyLane(const Int8& v) {
#if PERCEPTION_HAS_WIDER && !defined(__clang__)
  return __builtin_ia32_movmskps256(reinterpret_cast<Float8>(v)) != 0;  // their signs
#else
  Int4 halves[2];
  std::memcpy(halves, &v, sizeof halves);
  return anyLane(halves[0] | halves[1]);
#endif
}

template <class Bits, class Mask>
PERCEPTION_LANES void gather(Mask* masks, const Bits& bits) {
  Bits all;
  std::memcpy(&all, masks, sizeof all);
  all |= bits;
  std::memcpy(masks, &all, sizeof all);
}
template <class Half, class Mask>
PERCEPTION_LANES void gather(Mask* masks, const TwoHalves<Half>& bits) {
  gather(masks, bits.a), gather(masks + sizeof(Half) / sizeof(Mask), bits.b);
}

// For each group of cells along: begin of the cells and end of the first row that a beam of the fan
// may be in, as distances [cells] from the sensor.
template <class Float>
PERCEPTION_LANES void layOut(const Fan& fan, float* guides) {
  constexpr int kCount = LanesOf<Float>::kCount;
  for (std::int32_t i = fan.first; i <= fan.last; i += kCount) {
    const Float begin = static_cast<float>(i) + firstLanes<Float>() - fan.along;
    const Float low = fan.aside + fan.slope * larger(begin, all<Float>(0));
    store8(begin, guides + 2 * i);
    store8(roundedDown(low) + 1 - fan.aside, guides + 2 * i + kCount);
  }
}

// Layers between the heights at which the beam enters and leaves each row of a group of cells.
template <bool kRises, class Float, class Mask>
PERCEPTION_LANES void crossCells(const BeamStretch& beam, float along, float sensor_height,
                                 const float* guides, Mask* gathered) {
  using Layers = LayerBits<Float, Mask>;
  constexpr int kCount = LanesOf<Float>::kCount;
  const Float from = all<Float>(beam.from), to = all<Float>(beam.to);
  const Float height = all<Float>(sensor_height), up = all<Float>(beam.up);
  const Float per_across = all<Float>(1 / (beam.across > kLevelSlope ? beam.across : kLevelSlope));
  const auto first = static_cast<std::int32_t>(along + beam.from) / kCount * kCount;
  const auto last = static_cast<std::int32_t>(along + beam.to);
  for (std::int32_t i = first; i <= last; i += kCount) {
    const Float begin = load<Float>(guides + 2 * i), border = load<Float>(guides + 2 * i + kCount);
    const Float in = smaller(larger(begin, from), to);
    const Float leave = smaller(larger(begin + 1, from), to);
    const Float reached = border * per_across;
    const Float t1 = smaller(larger(reached, in), leave);
    const auto b0 = Layers::at(height + up * in), b1 = Layers::at(height + up * t1);
    Mask* const rows = gathered + kRows * i;
    gather(rows, Layers::where(in < t1, kRises ? b1 + b1 - b0 : b0 + b0 - b1));
    if (!anyLane(t1 < leave)) continue;
    const Float t2 = smaller(larger(reached + per_across, in), leave);
    const auto b2 = Layers::at(height + up * t2);
    gather(rows + kCount, Layers::where(t1 < t2, kRises ? b2 + b2 - b1 : b1 + b1 - b2));
    if (!anyLane(t2 < leave)) continue;  // most beams are in two rows at most
    const auto b3 = Layers::at(height + up * leave);
    gather(rows + 2 * kCount, Layers::where(t2 < leave, kRises ? b3 + b3 - b2 : b2 + b2 - b3));
  }
}

// Cells of the last group beyond the window's end hold no beam and mark nothing. Leaves `gathered`
// empty for the next fan.
template <class Float, class Mask>
PERCEPTION_LANES void markGathered(const Fan& fan, const float* guides, Mask* gathered,
                                   Mask* crossed) {
  constexpr int kCount = LanesOf<Float>::kCount;
  const std::ptrdiff_t side = fan.side;
  // Lanes before and behind the beams fall beside the window: their rows are within margin().
  constexpr std::int32_t kBefore = 2;
  const Float end = all<Float>(static_cast<float>(fan.cells - 1));
  const Float lowest = all<Float>(0.5F), highest = end + (0.5F + kBefore);
  for (std::int32_t i = fan.first; i <= fan.last; i += kCount) {
    const auto along = truncated(smaller(static_cast<float>(i) + firstLanes<Float>(), end));
    const Float middle = load<Float>(guides + 2 * i + kCount) + (fan.aside - 0.5F + kBefore);
    const auto row = truncated(smaller(larger(middle, lowest), highest)) - kBefore;
    std::int32_t column[kCount];
    store8(fan.column + along * fan.step + row * fan.side, column);
    Mask* const rows = gathered + kRows * i;
    for (int k = 0; k < kCount; ++k) {
      Mask* const first = crossed + column[k];
      first[0] |= rows[k];
      first[side] |= rows[k + kCount];
      first[2 * side] |= rows[k + 2 * kCount];
    }
    // Row by row: so short a call is a few instructions, one of all rows is a loop in the
    // processor.
    for (int row = 0; row < kRows; ++row)
      std::memset(rows + row * kCount, 0, kCount * sizeof(Mask));
  }
}

template <class Float, class Mask>
PERCEPTION_LANES void crossFan(const Fan& fan, const BeamStretch* beams, const std::uint16_t* order,
                               std::size_t count, float* guides, Mask* gathered, Mask* crossed) {
  layOut<Float>(fan, guides);
  const float along = fan.along, height = fan.height;
  for (std::size_t k = 0; k < count; ++k) {
    const BeamStretch beam = beams[order[k]];
    if (beam.up >= 0) {
      crossCells<true, Float>(beam, along, height, guides, gathered);
    } else {
      crossCells<false, Float>(beam, along, height, guides, gathered);
    }
  }
  markGathered<Float>(fan, guides, gathered, crossed);
}

// Like PERCEPTION_WIDER, with vectors of the width of each target. Templates cannot have targets.
#define PERCEPTION_CROSS_FAN(TARGET, Float, Mask)                                       \
  PERCEPTION_TARGET(TARGET)                                                             \
  void crossFanOf(const Fan& fan, const BeamStretch* beams, const std::uint16_t* order, \
                  std::size_t count, float* guides, Mask* gathered, Mask* crossed) {    \
    crossFan<Float>(fan, beams, order, count, guides, gathered, crossed);               \
  }
PERCEPTION_CROSS_FAN("default", Float4, std::uint32_t)
PERCEPTION_CROSS_FAN("default", Float4, std::uint64_t)
#if PERCEPTION_HAS_WIDER
PERCEPTION_CROSS_FAN("avx2", Float8, std::uint32_t)
PERCEPTION_CROSS_FAN("avx2", Float8, std::uint64_t)
#endif
#undef PERCEPTION_CROSS_FAN

}  // namespace

template <class Mask>
BeamFans<Mask>::BeamFans(int cells) : cells_(cells), beams_(kMost), fans_(kMost), order_(kMost) {
  const auto along = static_cast<std::size_t>((cells + kLanes - 1) / kLanes * kLanes);
  guides_.resize(2 * along), gathered_.resize(kRows * along);
}

template <class Mask>
void BeamFans<Mask>::begin(const WindowPlace& origin) {
  origin_ = origin;
  const auto cells = static_cast<float>(cells_);
  const float reach = std::max({origin.x, cells - origin.x, origin.y, cells - origin.y});
  bins_.per_slope = std::clamp(reach, 1.0F, kFarthest) / kWidest;
  bins_.slopes = static_cast<std::int32_t>(bins_.per_slope) + 1;
  ends_.resize(static_cast<std::size_t>(kOctants * bins_.slopes + 1));
}

// Counting sort; afterwards ends_ holds the begin of each fan, which is the end of the previous
// one.
template <class Mask>
void BeamFans<Mask>::sort() {
  std::fill(ends_.begin(), ends_.end(), std::uint16_t{0});
  for (std::size_t i = 0; i < count_; ++i) ++ends_[fans_[i]];
  std::uint16_t sum = 0;
  for (std::uint16_t& end : ends_) end = sum = static_cast<std::uint16_t>(sum + end);
  for (std::size_t i = 0; i < count_; ++i)
    order_[--ends_[fans_[i]]] = static_cast<std::uint16_t>(i);
}

template <class Mask>
void BeamFans<Mask>::mark(Mask* crossed) {
  if (count_ == 0) return;
  sort();
  for (int fan = 0; fan < kOctants * bins_.slopes; ++fan) markFan(fan, crossed);
  count_ = 0;
}

template <class Mask>
void BeamFans<Mask>::markFan(int number, Mask* crossed) {
  const std::size_t begin = ends_[static_cast<std::size_t>(number)];
  const std::size_t end = ends_[static_cast<std::size_t>(number) + 1];
  if (begin == end) return;
  const int octant = number / bins_.slopes, face = octant / 2;
  const bool along_x = face < 2, back = face % 2 != 0, falls = octant % 2 != 0;
  const float on = along_x ? origin_.x : origin_.y, aside = along_x ? origin_.y : origin_.x;
  const auto cells = static_cast<float>(cells_);
  const int step = along_x ? 1 : cells_, side = along_x ? cells_ : 1;
  Fan fan{};
  fan.along = back ? cells - on : on, fan.aside = falls ? cells - aside : aside;
  fan.height = origin_.z;
  fan.slope = static_cast<float>(number % bins_.slopes) / bins_.per_slope;
  fan.cells = cells_;
  fan.column = (back ? (cells_ - 1) * step : 0) + (falls ? (cells_ - 1) * side : 0);
  fan.step = back ? -step : step, fan.side = falls ? -side : side;
  float from = beams_[order_[begin]].from, to = beams_[order_[begin]].to;
  for (std::size_t k = begin + 1; k < end; ++k) {
    from = std::min(from, beams_[order_[k]].from), to = std::max(to, beams_[order_[k]].to);
  }
  fan.first = static_cast<std::int32_t>(fan.along + from) / kLanes * kLanes;
  fan.last = static_cast<std::int32_t>(fan.along + to);
  crossFanOf(fan, beams_.data(), order_.data() + begin, end - begin, guides_.data(),
             gathered_.data(), crossed);
}

template <class Mask>
std::size_t BeamFans<Mask>::memoryBytes() const {
  return beams_.capacity() * sizeof(BeamStretch) + gathered_.capacity() * sizeof(Mask) +
         guides_.capacity() * sizeof(float) +
         (fans_.capacity() + order_.capacity() + ends_.capacity()) * sizeof(std::uint16_t);
}

template class BeamFans<std::uint32_t>;
template class BeamFans<std::uint64_t>;

}  // namespace perception
