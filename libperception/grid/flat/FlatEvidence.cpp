#include "libperception/grid/flat/FlatEvidence.h"

#include <cstring>

#include "libperception/grid/flat/FlatBlock.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr std::size_t kStretch = 32;  // columns; most groups have no hit

template <std::size_t kCount>
PERCEPTION_LANES void addHits(float* __restrict values, std::uint8_t* __restrict weights,
                              std::uint8_t* __restrict crossed, const FlatEvidence& e) {
  for (std::size_t i = 0; i < kCount; ++i) {
    const float w = static_cast<float>(weights[i]) * (1.0F / FlatBlock::kWhole);
    const float v = values[i] * e.keep, left = v < 0 ? v - v * w * e.voided : v;
    const float miss = static_cast<float>(crossed[i]) * ((1 - w) * e.miss);
    const float sum = left + (w * e.hit + miss);
    const float bounded = sum < e.low ? e.low : sum;
    values[i] = bounded > e.high ? e.high : bounded;
    weights[i] = 0, crossed[i] = 0;
  }
}

template <std::size_t kCount>
PERCEPTION_LANES void addMisses(float* __restrict values, std::uint8_t* __restrict crossed,
                                const FlatEvidence& e) {
  for (std::size_t i = 0; i < kCount; ++i) {
    const float sum = values[i] * e.keep + static_cast<float>(crossed[i]) * e.miss;
    values[i] = sum < e.low ? e.low : sum;
    crossed[i] = 0;
  }
}

// Processes groups of kCount columns.
template <std::size_t kCount>
PERCEPTION_LANES void addStretches(float* __restrict values, std::size_t count, std::size_t& i,
                                   const FlatEvidence& e) {
  for (; i + kCount <= count; i += kCount) {
    std::uint64_t any = 0;
    for (std::size_t k = 0; k < kCount; k += sizeof any) {
      std::uint64_t eight;
      std::memcpy(&eight, e.weights + i + k, sizeof eight);
      any |= eight;
    }
    if (any == 0) {
      addMisses<kCount>(values + i, e.crossed + i, e);
    } else {
      addHits<kCount>(values + i, e.weights + i, e.crossed + i, e);
    }
  }
}

PERCEPTION_WIDEST void addAll(float* __restrict values, std::size_t count, const FlatEvidence e) {
  std::size_t i = 0;
  addStretches<kStretch>(values, count, i, e);
  addStretches<8>(values, count, i, e);
  for (; i < count; ++i) addHits<1>(values + i, e.weights + i, e.crossed + i, e);
}

}  // namespace

void addEvidence(float* values, std::size_t count, const FlatEvidence& evidence) {
  addAll(values, count, evidence);
}

}  // namespace perception
