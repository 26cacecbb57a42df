#include "libperception/grid/beams/BeamBlock.h"

#include "libperception/grid/beams/BeamCover.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr float kInside = 1e-3F;  // [cells] margin to the borders of window and last cell
constexpr float kShort = 1e-3F;   // [cells] horizontal length of a vertical beam
constexpr float kLevel = 1e-20F;  // [-] replaces a slope of zero
constexpr float kFinestBins = 1 << BeamCover::kFinest;
constexpr float kBinsAcross = BeamCover::kAcross * kFinestBins;
constexpr float kBinsUp = BeamCover::kUp * kFinestBins;

// Clips [from, to] to where a linear function with the values `a` at 0 and `b` at 1 is not
// negative.
template <class Float>
PERCEPTION_LANES void clip(const Float& a, const Float& b, Float& from, Float& to) {
  const Float zero = a / (a == b ? all<Float>(kLevel) : a - b);
  const Float begin = larger(from, b < 0 ? all<Float>(2.0F) : zero);
  from = a < 0 ? begin : from;
  to = b < 0 ? smaller(to, zero) : to;
}

// Distance along at which a beam of `slope` from `origin` enters its end cell.
template <class Float>
PERCEPTION_LANES Float entry(const Float& origin, const Float& end, const Float& slope) {
  const Float cell = roundedDown(end);
  const Float border = slope > 0 ? cell : cell + 1;
  const Float steep =
      slope > 0 ? larger(slope, all<Float>(kLevel)) : smaller(slope, all<Float>(-kLevel));
  return (border - origin) / steep;
}

// Whether a beam is within [0, size) at `from` and `to`, and hence in between, rounding included.
template <class Float>
PERCEPTION_LANES IntsOf<Float> within(const Float& origin, const Float& slope, const Float& from,
                                      const Float& to, float size) {
  const Float begin = origin + slope * from, end = origin + slope * to;
  return (begin >= 0) & (end >= 0) & (begin < size) & (end < size);
}

template <class Float>
PERCEPTION_LANES void prepareAll(BeamBlock& b, const WindowPlace& o, float cells, float layers,
                                 const FanBins& fans) {
  using Int = IntsOf<Float>;
  const float inside_cells = cells - kInside, inside_layers = layers - kInside;
  const Float last_slope = all<Float>(static_cast<float>(fans.slopes - 1));
  const Float ox = all<Float>(o.x), oy = all<Float>(o.y), oz = all<Float>(o.z);
  for (std::size_t i = 0; i < b.count; i += LanesOf<Float>::kCount) {
    const Float x = load<Float>(&b.x[i]), y = load<Float>(&b.y[i]), z = load<Float>(&b.z[i]);
    Float from = all<Float>(0.0F), to = all<Float>(1.0F);
    clip(all<Float>(o.low), load<Float>(&b.low[i]), from, to);
    clip(all<Float>(o.high), load<Float>(&b.high[i]), from, to);
    clip(ox - kInside, x - kInside, from, to), clip(inside_cells - ox, inside_cells - x, from, to);
    clip(oy - kInside, y - kInside, from, to), clip(inside_cells - oy, inside_cells - y, from, to);
    clip(oz - kInside, z - kInside, from, to);
    clip(inside_layers - oz, inside_layers - z, from, to);

    const Float dx = x - ox, dy = y - oy;
    const Int along_x = magnitude(dx) >= magnitude(dy);
    const Float ahead = along_x ? dx : dy;
    const Float length = larger(magnitude(ahead), all<Float>(kShort)), per_length = 1 / length;
    const Float across = (along_x ? dy : dx) * per_length, up = (z - oz) * per_length;
    const Float on = along_x ? ox : oy, aside = along_x ? oy : ox;
    const Float end_on = along_x ? x : y, end_aside = along_x ? y : x;
    const Float last = larger(entry(on, end_on, ahead * per_length),
                              larger(entry(aside, end_aside, across), entry(oz, z, up)));
    store8(across, &b.across[i]), store8(up, &b.up[i]);
    const Float begin = from * length, end = smaller(to * length, last - kInside);
    const Int inside = within(on, ahead * per_length, begin, end, cells) &
                       within(aside, across, begin, end, cells) &
                       within(oz + all<Float>(0.0F), up, begin, end, layers);
    store8(begin, &b.from[i]), store8(inside ? end : begin, &b.to[i]);
    // The last bin includes a slope of one.
    store8(truncated(smaller((across + 1) * kBinsAcross, all<Float>(2 * kBinsAcross - 0.5F))),
           &b.bin_across[i]);
    store8(truncated(roundedDown(up * kBinsUp)), &b.bin_up[i]);
    const Int falls = 1 + (ahead > 0);
    const Int face = falls + (2 & ~along_x);
    store8(face, &b.face[i]);
    const Int slope = truncated(smaller(magnitude(across) * fans.per_slope, last_slope));
    store8((face * 2 - (across < 0)) * fans.slopes + slope, &b.fan[i]);
  }
}

// Like PERCEPTION_WIDER, with vectors of the width of each target.
PERCEPTION_TARGET("default")
void prepareBeams(BeamBlock& b, const WindowPlace& o, float cells, float layers,
                  const FanBins& fans) {
  prepareAll<Float4>(b, o, cells, layers, fans);
}
#if PERCEPTION_HAS_WIDER
PERCEPTION_TARGET("avx2")
void prepareBeams(BeamBlock& b, const WindowPlace& o, float cells, float layers,
                  const FanBins& fans) {
  prepareAll<Float8>(b, o, cells, layers, fans);
}
#endif

}  // namespace

void BeamBlock::prepare(const WindowPlace& origin, int cells, int layers, const FanBins& fans) {
  prepareBeams(*this, origin, static_cast<float>(cells), static_cast<float>(layers), fans);
}

}  // namespace perception
