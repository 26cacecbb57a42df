#include "libperception/grid/BeamBlock.h"

#include "libperception/core/Lanes.h"
#include "libperception/core/Wider.h"
#include "libperception/grid/BeamCover.h"

namespace perception {
namespace {

constexpr float kInside = 1e-3F;  // [cells] by which stretches stay within window and last cell
constexpr float kShort = 1e-3F;   // [cells] of a beam that stands upright
constexpr float kLevel = 1e-20F;  // [-] instead of a slope of zero
constexpr float kFinestBins = 1 << BeamCover::kFinest;
constexpr float kBinsAcross = BeamCover::kAcross * kFinestBins;
constexpr float kBinsUp = BeamCover::kUp * kFinestBins;

// Shrinks [from, to] to where a linear function that is `a` at 0 and `b` at 1 is not negative.
PERCEPTION_LANES void clip(const Float8& a, const Float8& b, Float8& from, Float8& to) {
  const Float8 zero = a / (a == b ? eight(kLevel) : a - b);
  const Float8 begin = larger(from, b < 0 ? eight(2.0F) : zero);
  from = a < 0 ? begin : from;
  to = b < 0 ? smaller(to, zero) : to;
}

// Where a beam of `slope` enters the cell of its end, from `origin` on: distance along.
PERCEPTION_LANES Float8 entry(const Float8& origin, const Float8& end, const Float8& slope) {
  const Float8 cell = roundedDown(end);
  const Float8 border = slope > 0 ? cell : cell + 1;
  const Float8 steep = slope > 0 ? larger(slope, eight(kLevel)) : smaller(slope, eight(-kLevel));
  return (border - origin) / steep;
}

// Whether a beam is within [0, size) at `from` and `to`, whatever the rounding. So it is between.
PERCEPTION_LANES Int8 within(const Float8& origin, const Float8& slope, const Float8& from,
                             const Float8& to, float size) {
  const Float8 begin = origin + slope * from, end = origin + slope * to;
  return (begin >= 0) & (end >= 0) & (begin < size) & (end < size);
}

PERCEPTION_WIDER void prepareBeams(BeamBlock& b, const WindowPlace& o, float cells, float layers,
                                   const FanBins fans) {
  const float inside_cells = cells - kInside, inside_layers = layers - kInside;
  const Float8 ox = eight(o.x), oy = eight(o.y), oz = eight(o.z);
  for (std::size_t i = 0; i < b.count; i += kLanes) {
    const Float8 x = load8(&b.x[i]), y = load8(&b.y[i]), z = load8(&b.z[i]);
    Float8 from = eight(0.0F), to = eight(1.0F);
    clip(eight(o.low), load8(&b.low[i]), from, to);
    clip(eight(o.high), load8(&b.high[i]), from, to);
    clip(ox - kInside, x - kInside, from, to), clip(inside_cells - ox, inside_cells - x, from, to);
    clip(oy - kInside, y - kInside, from, to), clip(inside_cells - oy, inside_cells - y, from, to);
    clip(oz - kInside, z - kInside, from, to);
    clip(inside_layers - oz, inside_layers - z, from, to);

    const Float8 dx = x - ox, dy = y - oy;
    const Int8 along_x = magnitude(dx) >= magnitude(dy);
    const Float8 ahead = along_x ? dx : dy;
    const Float8 length = larger(magnitude(ahead), eight(kShort)), per_length = 1 / length;
    const Float8 across = (along_x ? dy : dx) * per_length, up = (z - oz) * per_length;
    const Float8 on = along_x ? ox : oy, aside = along_x ? oy : ox;
    const Float8 end_on = along_x ? x : y, end_aside = along_x ? y : x;
    const Float8 last = larger(entry(on, end_on, ahead * per_length),
                               larger(entry(aside, end_aside, across), entry(oz, z, up)));
    store8(across, &b.across[i]), store8(up, &b.up[i]);
    const Float8 begin = from * length, end = smaller(to * length, last - kInside);
    const Int8 inside = within(on, ahead * per_length, begin, end, cells) &
                        within(aside, across, begin, end, cells) &
                        within(oz + eight(0.0F), up, begin, end, layers);
    store8(begin, &b.from[i]), store8(inside ? end : begin, &b.to[i]);
    // The last bin holds a slope of one, too.
    store8(truncated(smaller((across + 1) * kBinsAcross, eight(2 * kBinsAcross - 0.5F))),
           &b.bin_across[i]);
    store8(truncated(roundedDown(up * kBinsUp)), &b.bin_up[i]);
    const Int8 falls = ahead > 0 ? eight(0) : eight(1);
    const Int8 face = along_x ? falls : falls + 2;
    store8(face, &b.face[i]);
    const Int8 slope =
        smaller(truncated(magnitude(across) * fans.per_slope), fans.slopes - 1 + eight(0));
    store8((face * 2 - (across < 0)) * fans.slopes + slope, &b.fan[i]);
  }
}

}  // namespace

void BeamBlock::prepare(const WindowPlace& origin, int cells, int layers, const FanBins& fans) {
  prepareBeams(*this, origin, static_cast<float>(cells), static_cast<float>(layers), fans);
}

}  // namespace perception
