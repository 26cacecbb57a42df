#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "libperception/simd/Vector8.h"

namespace perception {

/// Arithmetic on the log-odds of a column of cells, eight layers at once: 16-bit integers in steps
/// of 1/2048, in which the largest sum, 7 + 5, is below 32767.
class LogOddsColumn {
 public:
  static constexpr double kUnits = 2048;
  static constexpr int kGroup = 4;  ///< the number of layers is a multiple

  LogOddsColumn(double hit, double miss, double low, double high)
      : hit_(eight(units(hit))),
        miss_(eight(units(miss))),
        low_(eight(units(low))),
        high_(eight(units(high))) {}

  static std::int16_t units(double log_odds) {
    return static_cast<std::int16_t>(std::lround(log_odds * kUnits));
  }
  /// The loss 1 - keep, as fixed-point number for update() and clear().
  static std::int16_t lossOf(double keep) {
    return static_cast<std::int16_t>(std::min(32767L, std::lround((1 - keep) * 32768)));
  }

  std::int16_t hit() const { return hit_[0]; }    ///< what a hit adds, in units
  std::int16_t miss() const { return miss_[0]; }  ///< what a beam that passes adds
  std::int16_t low() const { return low_[0]; }    ///< bounds of the log-odds
  std::int16_t high() const { return high_[0]; }

  /// Applies the loss, then adds the evidence of a scan, a bit per layer. `judged`: hits reset
  /// negative log-odds (voidedBy() with weights of one).
  template <class Mask>
  PERCEPTION_LANES void update(std::int16_t* values, int layers, std::int16_t loss, Mask hit,
                               Mask crossed, bool judged) const {
    const Short8 losses = eight(loss);
    for (; layers > 0; layers -= 8, values += 8) {
      Short8 v = load(values, layers);
      v -= highHalf(v + v, losses);
      const Short8 hits = spread(hit);
      if (judged) v &= ~(hits & (v < 0));
      v += (hits & hit_) | (spread(crossed) & miss_);
      v = v < low_ ? low_ : v;
      v = v > high_ ? high_ : v;
      store(v, values, layers);
      if constexpr (sizeof(Mask) > 1) hit = hit >> 8, crossed = crossed >> 8;
    }
  }
  /// The same without hits.
  template <class Mask>
  PERCEPTION_LANES void clear(std::int16_t* values, int layers, std::int16_t loss,
                              Mask crossed) const {
    const Short8 losses = eight(loss);
    for (; layers > 0; layers -= 8, values += 8) {
      Short8 v = load(values, layers);
      v -= highHalf(v + v, losses);
      v += spread(crossed) & miss_;
      v = v < low_ ? low_ : v;
      store(v, values, layers);
      if constexpr (sizeof(Mask) > 1) crossed = crossed >> 8;
    }
  }

  /// False: all values of the column are below `least`.
  PERCEPTION_LANES static bool mayReach(const std::int16_t* values, int layers,
                                        std::int16_t least) {
    const Short8 leasts = eight(least);
    Short8 reached{};
    for (; layers > 0; layers -= 8, values += 8) reached |= load(values, layers) >= leasts;
    const auto halves = reinterpret_cast<Long2>(reached);
    return (halves[0] | halves[1]) != 0;
  }

 private:
  using Short8 = std::int16_t __attribute__((vector_size(16)));

  PERCEPTION_LANES static Short8 eight(std::int16_t v) { return Short8{v, v, v, v, v, v, v, v}; }
  using Long2 = std::int64_t __attribute__((vector_size(16)));

  PERCEPTION_LANES static Short8 load(const std::int16_t* values, int layers) {
    Short8 v;
    if (layers >= 8) {
      std::memcpy(&v, values, sizeof v);
      return v;
    }
    std::int64_t four;  // by an integer: avoids a store-forwarding stall
    std::memcpy(&four, values, sizeof four);
    return reinterpret_cast<Short8>(Long2{four, 0});
  }
  PERCEPTION_LANES static void store(const Short8& v, std::int16_t* values, int layers) {
    std::memcpy(values, &v, layers >= 8 ? 16 : 8);
  }
  // The low eight bits of a number as eight words of ones or zeros.
  template <class Mask>
  PERCEPTION_LANES static Short8 spread(Mask bits) {
    constexpr Short8 kBits = {1, 2, 4, 8, 16, 32, 64, 128};
    return (eight(static_cast<std::int16_t>(bits)) & kBits) == kBits;
  }
  // a b / 2^16, rounded down.
  PERCEPTION_LANES static Short8 highHalf(const Short8& a, const Short8& b) {
#if defined(__SSE2__)
    return reinterpret_cast<Short8>(
        _mm_mulhi_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
    using Int8 = std::int32_t __attribute__((vector_size(32)));
    return __builtin_convertvector(
        (__builtin_convertvector(a, Int8) * __builtin_convertvector(b, Int8)) >> 16, Short8);
#endif
  }

  Short8 hit_, miss_, low_, high_;
};

}  // namespace perception
