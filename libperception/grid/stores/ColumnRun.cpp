#include "libperception/grid/stores/ColumnRun.h"

#include <algorithm>
#include <limits>

#include "libperception/simd/Dispatch.h"
#if PERCEPTION_HAS_WIDER
#include <immintrin.h>
#endif

namespace perception {
namespace {

/// Rotates masks, whose bit k is layer k of the window, to the layers of the array.
template <class Mask>
struct Turn {
  unsigned up, down;
  Mask all;  ///< layers

  Turn(int layers, unsigned turn)
      : up(turn), down(turn == 0 ? 0 : static_cast<unsigned>(layers) - turn) {
    constexpr int kBits = static_cast<int>(8 * sizeof(Mask));
    all = static_cast<Mask>(~Mask{0} >> (kBits - layers));
  }
  Mask operator()(Mask mask) const { return (mask << up | mask >> down) & all; }
};

#if PERCEPTION_HAS_WIDER
/// The arithmetic of LogOddsColumn on sixteen layers at once.
class Sixteens {
 public:
  PERCEPTION_TARGET("avx2")
  explicit Sixteens(const LogOddsColumn& rules)
      : rules_(rules),
        hit_(_mm256_set1_epi16(rules.hit())),
        miss_(_mm256_set1_epi16(rules.miss())),
        low_(_mm256_set1_epi16(rules.low())),
        high_(_mm256_set1_epi16(rules.high())) {}

  PERCEPTION_TARGET("avx2")
  void clear(std::int16_t* values, int layers, std::int16_t loss, std::uint64_t crossed) const {
    for (; layers >= 16; layers -= 16, values += 16, crossed >>= 16) {
      const __m256i v = decayed(values, loss);
      const __m256i cleared = _mm256_add_epi16(v, _mm256_and_si256(spread(crossed), miss_));
      store(_mm256_max_epi16(cleared, low_), values);
    }
    if (layers > 0) rules_.clear(values, layers, loss, crossed);
  }

  PERCEPTION_TARGET("avx2")
  void update(std::int16_t* values, int layers, std::int16_t loss, std::uint64_t hit,
              std::uint64_t crossed, bool judged) const {
    for (; layers >= 16; layers -= 16, values += 16, hit >>= 16, crossed >>= 16) {
      __m256i v = decayed(values, loss);
      const __m256i hits = spread(hit);
      if (judged) {
        const __m256i below = _mm256_cmpgt_epi16(_mm256_setzero_si256(), v);
        v = _mm256_andnot_si256(_mm256_and_si256(hits, below), v);
      }
      const __m256i passed = _mm256_and_si256(spread(crossed), miss_);
      v = _mm256_add_epi16(v, _mm256_or_si256(_mm256_and_si256(hits, hit_), passed));
      store(_mm256_min_epi16(_mm256_max_epi16(v, low_), high_), values);
    }
    if (layers > 0) rules_.update(values, layers, loss, hit, crossed, judged);
  }

 private:
  PERCEPTION_TARGET("avx2")
  static __m256i decayed(const std::int16_t* values, std::int16_t loss) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values));
    return _mm256_sub_epi16(v, _mm256_mulhi_epi16(_mm256_add_epi16(v, v), _mm256_set1_epi16(loss)));
  }
  PERCEPTION_TARGET("avx2")
  static void store(const __m256i& v, std::int16_t* values) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(values), v);
  }
  /// The low sixteen bits of a number as words of ones or zeros.
  PERCEPTION_TARGET("avx2")
  static __m256i spread(std::uint64_t bits) {
    const __m256i each = _mm256_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096,
                                           8192, 16384, std::numeric_limits<std::int16_t>::min());
    const __m256i all = _mm256_set1_epi16(static_cast<std::int16_t>(bits));
    return _mm256_cmpeq_epi16(_mm256_and_si256(all, each), each);
  }

  const LogOddsColumn rules_;
  const __m256i hit_, miss_, low_, high_;
};
#endif

/// Columns that are looked at together, since most of a window have no evidence in a scan.
constexpr std::size_t kAtOnce = 16;

/// Whether one of kAtOnce columns has evidence; without branches, so that the compiler vectorizes
/// it.
template <class Mask>
PERCEPTION_LANES bool anyEvidence(const Mask* hit, const Mask* crossed) {
  Mask any = 0;
  for (std::size_t k = 0; k < kAtOnce; ++k) any |= hit[k] | crossed[k];
  return any != 0;
}

template <class Mask, class Rules>
PERCEPTION_LANES void updateAll(const Rules& column, const ColumnRun<Mask>& run, ColumnAges& ages) {
  const Turn<Mask> turned(run.layers, run.turn);
  const int layers = run.layers;
  const bool judged = run.judged;
  for (std::size_t first = 0; first < run.count; first += kAtOnce) {
    const std::size_t end = std::min(run.count, first + kAtOnce);
    if (end == first + kAtOnce && !anyEvidence(run.hit + first, run.crossed + first)) continue;
    std::int16_t* values = run.values + first * static_cast<std::size_t>(layers);
    for (std::size_t i = first; i < end; ++i, values += layers) {
      const Mask hit = run.hit[i], crossed = run.crossed[i] & ~hit;
      if ((hit | crossed) == 0) continue;
      run.hit[i] = run.crossed[i] = 0;
      const std::int16_t loss = ages.loss(run.slot + i);
      ages.touch(run.slot + i);
      if (hit == 0) {
        column.clear(values, layers, loss, turned(crossed));
      } else {
        run.was_hit[i] = 1;
        column.update(values, layers, loss, turned(hit), turned(crossed), judged);
      }
    }
  }
}

// Like PERCEPTION_WIDER, with vectors of the width of each target.
#define PERCEPTION_UPDATE_RUN(TARGET, Rules, Mask)                                           \
  PERCEPTION_TARGET(TARGET)                                                                  \
  void updateRun(const LogOddsColumn& rules, const ColumnRun<Mask>& run, ColumnAges& ages) { \
    updateAll(Rules(rules), run, ages);                                                      \
  }
PERCEPTION_UPDATE_RUN("default", LogOddsColumn, std::uint32_t)
PERCEPTION_UPDATE_RUN("default", LogOddsColumn, std::uint64_t)
#if PERCEPTION_HAS_WIDER
PERCEPTION_UPDATE_RUN("avx2", Sixteens, std::uint32_t)
PERCEPTION_UPDATE_RUN("avx2", Sixteens, std::uint64_t)
#endif
#undef PERCEPTION_UPDATE_RUN

}  // namespace

void updateColumns(const LogOddsColumn& rules, const ColumnRun<std::uint32_t>& run,
                   ColumnAges& ages) {
  updateRun(rules, run, ages);
}
void updateColumns(const LogOddsColumn& rules, const ColumnRun<std::uint64_t>& run,
                   ColumnAges& ages) {
  updateRun(rules, run, ages);
}

}  // namespace perception
