#include "libperception/simd/Compress.h"

#include <cstring>

#include "libperception/simd/Dispatch.h"

#if PERCEPTION_HAS_WIDER
#include <immintrin.h>
#endif

namespace perception {
namespace {

std::uint32_t numberAt(const void* column, std::size_t row) {
  std::uint32_t number;
  std::memcpy(&number, static_cast<const char*>(column) + 4 * row, 4);
  return number;
}

/// pack() from row `first` on, after `kept` rows were packed.
template <std::size_t kColumns>
std::size_t packRows(const std::int32_t* marks, std::size_t first, std::size_t count,
                     std::size_t kept, const std::array<Column, kColumns>& columns) {
  for (std::size_t row = first; row < count; ++row) {  // an unmarked row is overwritten by the next
    const bool marked = marks[row] != 0;
    for (const Column& column : columns) {
      const std::uint32_t number = numberAt(column.from, row);
      std::memcpy(static_cast<char*>(column.to) + 4 * kept, &number, 4);
    }
    kept += marked;
  }
  return kept;
}

std::size_t packPlacesOf(const std::int32_t* marks, std::size_t row, std::size_t count,
                         std::size_t kept, std::uint32_t first, std::uint32_t* places) {
  for (; row < count; ++row) {
    places[kept] = first + static_cast<std::uint32_t>(row);
    kept += marks[row] != 0;
  }
  return kept;
}

#if PERCEPTION_HAS_WIDER

/// For each mask of eight rows the indices of its set bits, a byte each.
struct Orders {
  Orders() {
    for (std::size_t set = 0; set < bytes.size(); ++set) {
      bytes[set] = 0;
      for (std::uint64_t row = 0, to = 0; row < 8; ++row)
        if ((set >> row & 1) != 0) bytes[set] |= row << (8 * to++);
    }
  }
  std::array<std::uint64_t, 256> bytes;
};
const Orders kOrders;

#define PERCEPTION_AVX2 __attribute__((target("avx2,popcnt")))

/// Marks of eight rows and the permutation that moves the marked ones to the front.
struct Move {
  __m256i order;
  std::size_t count;
};
PERCEPTION_AVX2 inline Move moveOf(const std::int32_t* marks) {
  const __m256i some = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(marks));
  const __m256i none = _mm256_cmpeq_epi32(some, _mm256_setzero_si256());
  const unsigned set = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(none))) ^ 0xFFU;
  const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(&kOrders.bytes[set]));
  return {_mm256_cvtepu8_epi32(bytes), static_cast<std::size_t>(_mm_popcnt_u32(set))};
}

template <std::size_t kColumns>
PERCEPTION_AVX2 std::size_t packEights(const std::int32_t* marks, std::size_t count,
                                       const std::array<Column, kColumns>& columns) {
  const std::array<Column, kColumns> own = columns;  // a copy, which stores cannot alias
  std::size_t kept = 0;
  for (std::size_t row = 0; row + 8 <= count; row += 8) {
    const Move move = moveOf(marks + row);
    for (std::size_t c = 0; c < kColumns; ++c) {
      const auto* from = static_cast<const char*>(own[c].from) + 4 * row;
      auto* to = static_cast<char*>(own[c].to) + 4 * kept;
      const __m256i numbers = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                          _mm256_permutevar8x32_epi32(numbers, move.order));
    }
    kept += move.count;
  }
  return packRows(marks, count / 8 * 8, count, kept, columns);
}

PERCEPTION_AVX2 std::size_t packPlacesByEights(const std::int32_t* marks, std::size_t count,
                                               std::uint32_t first, std::uint32_t* places) {
  std::size_t kept = 0;
  __m256i base = _mm256_set1_epi32(static_cast<int>(first));
  for (std::size_t row = 0; row + 8 <= count; row += 8) {
    const Move move = moveOf(marks + row);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(places + kept),
                        _mm256_add_epi32(move.order, base));
    base = _mm256_add_epi32(base, _mm256_set1_epi32(8));
    kept += move.count;
  }
  return packPlacesOf(marks, count / 8 * 8, count, kept, first, places);
}

#define PERCEPTION_AVX512 __attribute__((target("avx512f,popcnt")))

template <std::size_t kColumns>
PERCEPTION_AVX512 std::size_t packSixteens(const std::int32_t* marks, std::size_t count,
                                           const std::array<Column, kColumns>& columns) {
  const std::array<Column, kColumns> own = columns;
  std::size_t kept = 0;
  for (std::size_t row = 0; row + 16 <= count; row += 16) {
    const __m512i some = _mm512_loadu_si512(marks + row);
    const __mmask16 set = _mm512_test_epi32_mask(some, some);
    for (std::size_t c = 0; c < kColumns; ++c) {
      const auto* from = static_cast<const char*>(own[c].from) + 4 * row;
      auto* to = static_cast<char*>(own[c].to) + 4 * kept;
      _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(set, _mm512_loadu_si512(from)));
    }
    kept += static_cast<std::size_t>(_mm_popcnt_u32(set));
  }
  return packRows(marks, count / 16 * 16, count, kept, columns);
}

bool hasAvx512() {
  static const bool has = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("popcnt");
  return has;
}
bool hasAvx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
  return has;
}

#endif

}  // namespace

template <std::size_t kColumns>
std::size_t pack(const std::int32_t* marks, std::size_t count,
                 const std::array<Column, kColumns>& columns) {
#if PERCEPTION_HAS_WIDER
  if (hasAvx512()) return packSixteens(marks, count, columns);
  if (hasAvx2()) return packEights(marks, count, columns);
#endif
  return packRows(marks, 0, count, 0, columns);
}
template std::size_t pack(const std::int32_t*, std::size_t, const std::array<Column, 4>&);
template std::size_t pack(const std::int32_t*, std::size_t, const std::array<Column, 6>&);

std::size_t packPlaces(const std::int32_t* marks, std::size_t count, std::uint32_t first,
                       std::uint32_t* places) {
#if PERCEPTION_HAS_WIDER
  if (hasAvx2()) return packPlacesByEights(marks, count, first, places);
#endif
  return packPlacesOf(marks, 0, count, 0, first, places);
}

}  // namespace perception
