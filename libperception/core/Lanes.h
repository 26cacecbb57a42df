#pragma once
#include <cstdint>
#include <cstring>

namespace perception {

/// Eight numbers at once: one register where PERCEPTION_WIDER finds AVX2, two elsewhere. For loops
/// that the compiler does not make vectors of by itself. Comparisons give lanes of 0 or -1.
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));
constexpr int kLanes = 8;

// Always part of their caller, so that they are compiled as wide as it is, and nothing is handed
// over.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
#define PERCEPTION_LANES inline __attribute__((always_inline))

PERCEPTION_LANES Float8 eight(float v) { return Float8{v, v, v, v, v, v, v, v}; }
PERCEPTION_LANES Int8 eight(std::int32_t v) { return Int8{v, v, v, v, v, v, v, v}; }
PERCEPTION_LANES Int8 firstEight() { return Int8{0, 1, 2, 3, 4, 5, 6, 7}; }

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
PERCEPTION_LANES Float8 magnitude(const Float8& v) {
  return reinterpret_cast<Float8>(reinterpret_cast<Int8>(v) &
                                  eight(0x7FFFFFFF));  // without the sign
}
PERCEPTION_LANES Int8 truncated(const Float8& v) { return __builtin_convertvector(v, Int8); }
PERCEPTION_LANES Float8 asFloats(const Int8& v) { return __builtin_convertvector(v, Float8); }
PERCEPTION_LANES Float8 roundedDown(const Float8& v) {
  const Float8 whole = asFloats(truncated(v));
  return whole > v ? whole - 1 : whole;
}

#pragma GCC diagnostic pop

}  // namespace perception
