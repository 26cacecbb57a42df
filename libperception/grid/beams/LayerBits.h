#pragma once
#include <cstdint>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "libperception/simd/Vector8.h"

namespace perception {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

/// Bit masks of 32 or 64 layers for several cells: eight with AVX2, which shifts per lane, else
/// four.
template <class Float, class Mask>
struct LayerBits;

/// Masks of the first and of the last cells, each in a register.
template <class Half>
struct TwoHalves {
  Half a, b;
  PERCEPTION_LANES TwoHalves operator+(const TwoHalves& o) const { return {a + o.a, b + o.b}; }
  PERCEPTION_LANES TwoHalves operator-(const TwoHalves& o) const { return {a - o.a, b - o.b}; }
};

template <>
struct LayerBits<Float8, std::uint32_t> {
  using Bits = std::uint32_t __attribute__((vector_size(32)));
  /// Bit of the layer at each height [cells].
  PERCEPTION_LANES static Bits at(const Float8& z) {
    return Bits{1, 1, 1, 1, 1, 1, 1, 1} << reinterpret_cast<Bits>(truncated(z));
  }
  PERCEPTION_LANES static Bits where(const Int8& lanes, const Bits& bits) {
    return reinterpret_cast<Bits>(lanes) & bits;
  }
};

template <>
struct LayerBits<Float8, std::uint64_t> {
  using Half = std::uint64_t __attribute__((vector_size(32)));
  using Bits = TwoHalves<Half>;
  PERCEPTION_LANES static Bits at(const Float8& z) {
    const Bits layer = halves(truncated(z));
    constexpr Half kOne = {1, 1, 1, 1};
    return {kOne << layer.a, kOne << layer.b};
  }
  PERCEPTION_LANES static Bits where(const Int8& lanes, const Bits& bits) {
    const Bits wanted = halves(lanes);
    return {wanted.a & bits.a, wanted.b & bits.b};
  }

 private:
  /// With their signs.
  PERCEPTION_LANES static Bits halves(const Int8& v) {
    using Long8 = std::int64_t __attribute__((vector_size(64)));
    const Long8 wide = __builtin_convertvector(v, Long8);
    return {reinterpret_cast<Half>(__builtin_shufflevector(wide, wide, 0, 1, 2, 3)),
            reinterpret_cast<Half>(__builtin_shufflevector(wide, wide, 4, 5, 6, 7))};
  }
};

template <>
struct LayerBits<Float4, std::uint32_t> {
  using Bits = std::uint32_t __attribute__((vector_size(16)));
  PERCEPTION_LANES static Bits at(const Float4& z) { return power(truncated(z)); }
  PERCEPTION_LANES static Bits where(const Int4& lanes, const Bits& bits) {
    return reinterpret_cast<Bits>(lanes) & bits;
  }
  /// 2^layer, by constructing the float of that value. The SSE2 conversion of 2^31, out of range,
  /// gives just that bit.
  PERCEPTION_LANES static Bits power(const Int4& layer) {
    constexpr std::int32_t kBias = 127, kMantissa = 23;
    const Int4 value = (layer + kBias) << kMantissa;
#if defined(__SSE2__)
    return reinterpret_cast<Bits>(_mm_cvttps_epi32(reinterpret_cast<__m128>(value)));
#else
    return __builtin_convertvector(reinterpret_cast<Float4>(value), Bits);
#endif
  }
};

template <>
struct LayerBits<Float4, std::uint64_t> {
  using Half = std::uint64_t __attribute__((vector_size(16)));
  using Bits = TwoHalves<Half>;
  PERCEPTION_LANES static Bits at(const Float4& z) {
    using Low = LayerBits<Float4, std::uint32_t>;
    const Int4 layer = truncated(z), upper = layer > 31;
    const Int4 bit = reinterpret_cast<Int4>(Low::power(layer & 31));
    const Int4 low = bit & ~upper, high = bit & upper;
    return {reinterpret_cast<Half>(__builtin_shufflevector(low, high, 0, 4, 1, 5)),
            reinterpret_cast<Half>(__builtin_shufflevector(low, high, 2, 6, 3, 7))};
  }
  PERCEPTION_LANES static Bits where(const Int4& lanes, const Bits& bits) {
    return {reinterpret_cast<Half>(__builtin_shufflevector(lanes, lanes, 0, 0, 1, 1)) & bits.a,
            reinterpret_cast<Half>(__builtin_shufflevector(lanes, lanes, 2, 2, 3, 3)) & bits.b};
  }
};

#pragma GCC diagnostic pop

}  // namespace perception
