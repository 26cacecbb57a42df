#include "libperception/grid/ColumnRun.h"

#include "libperception/simd/Dispatch.h"

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

template <class Mask>
PERCEPTION_LANES void updateAll(const LogOddsColumn& rules, const ColumnRun<Mask>& run,
                                ColumnAges& ages) {
  const LogOddsColumn column = rules;
  const Turn<Mask> turned(run.layers, run.turn);
  const int layers = run.layers;
  const bool judged = run.judged;
  std::int16_t* values = run.values;
  for (std::size_t i = 0; i < run.count; ++i, values += layers) {
    const Mask hit = run.hit[i], crossed = run.crossed[i] & ~hit;
    if ((hit | crossed) == 0) continue;
    run.hit[i] = run.crossed[i] = 0;
    const std::int16_t loss = ages.loss(run.slot + i);
    ages.touch(run.slot + i);
    if (hit == 0) {
      column.clear(values, layers, loss, turned(crossed));
    } else {
      column.update(values, layers, loss, turned(hit), turned(crossed), judged);
    }
  }
}

PERCEPTION_WIDER void updateRun(const LogOddsColumn& rules, const ColumnRun<std::uint32_t>& run,
                                ColumnAges& ages) {
  updateAll(rules, run, ages);
}
PERCEPTION_WIDER void updateRun(const LogOddsColumn& rules, const ColumnRun<std::uint64_t>& run,
                                ColumnAges& ages) {
  updateAll(rules, run, ages);
}

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
