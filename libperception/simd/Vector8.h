#pragma once
#include <cstdint>
#include <cstring>

namespace perception {

/// Eight numbers: one register in code compiled for AVX2 (PERCEPTION_WIDER), two elsewhere. For
/// loops that the compiler does not vectorize itself. Comparisons give lanes of 0 or -1.
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));
constexpr int kLanes = 8;

/// Four numbers, for loops with many comparisons: with SSE registers, comparisons of eight are
/// split into scalars. Such a loop is a template on `Float`.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Integer vector and number of lanes of a vector of floats.
template <class Float>
struct LanesOf;
template <>
struct LanesOf<Float8> {
  using Int = Int8;
  static constexpr int kCount = 8;
};
template <>
struct LanesOf<Float4> {
  using Int = Int4;
  static constexpr int kCount = 4;
};
template <class Float>
using IntsOf = typename LanesOf<Float>::Int;

// Always inlined, so that they are compiled for the caller's target and pass vectors in registers.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
#define PERCEPTION_LANES inline __attribute__((always_inline))

PERCEPTION_LANES Float8 eight(float v) { return Float8{v, v, v, v, v, v, v, v}; }
PERCEPTION_LANES Int8 eight(std::int32_t v) { return Int8{v, v, v, v, v, v, v, v}; }

/// The same number in all lanes.
template <class Float>
PERCEPTION_LANES Float all(float v) {
  if constexpr (sizeof(Float) == sizeof(Float8)) {
    return eight(v);
  } else {
    return Float{v, v, v, v};
  }
}
/// 0, 1, 2 and so on.
template <class Float>
PERCEPTION_LANES Float firstLanes() {
  if constexpr (sizeof(Float) == sizeof(Float8)) {
    return Float{0, 1, 2, 3, 4, 5, 6, 7};
  } else {
    return Float{0, 1, 2, 3};
  }
}

template <class Float>
PERCEPTION_LANES Float load(const float* from) {
  Float v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
PERCEPTION_LANES Float8 load8(const float* from) {
  Float8 v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class Lanes, class Number>
PERCEPTION_LANES void store8(const Lanes& v, Number* to) {
  std::memcpy(to, &v, sizeof v);
}

template <class Lanes>
PERCEPTION_LANES Lanes larger(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}
template <class Lanes>
PERCEPTION_LANES Lanes smaller(const Lanes& a, const Lanes& b) {
  return a < b ? a : b;
}
template <class Float>
PERCEPTION_LANES Float magnitude(const Float& v) {
  return reinterpret_cast<Float>(reinterpret_cast<IntsOf<Float>>(v) &
                                 0x7FFFFFFF);  // without the sign
}
template <class Float>
PERCEPTION_LANES IntsOf<Float> truncated(const Float& v) {
  return __builtin_convertvector(v, IntsOf<Float>);
}
PERCEPTION_LANES Float8 asFloats(const Int8& v) { return __builtin_convertvector(v, Float8); }
PERCEPTION_LANES Float4 asFloats(const Int4& v) { return __builtin_convertvector(v, Float4); }
template <class Float>
PERCEPTION_LANES Float roundedDown(const Float& v) {
  const Float whole = asFloats(truncated(v));
  return whole > v ? whole - 1 : whole;
}

#pragma GCC diagnostic pop

}  // namespace perception
