#include "libperception/grid/FlatBeams.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/Angle.h"
#include "libperception/core/Lanes.h"
#include "libperception/core/RoughBearing.h"
#include "libperception/core/Wider.h"

namespace perception {
namespace {

using Rose = FlatBeams::Rose;

// Points in the sensor's own cell and what is no number have the bearing behind the last one.
PERCEPTION_LANES std::int32_t bearingOf(float dx, float dy, float range2, std::int32_t finite,
                                        const Rose& rose) {
  const auto bin = static_cast<std::int32_t>((roughBearing(dx, dy) + 3.1416F) * rose.per_radian);
  const std::int32_t bounded = bin < rose.count ? bin : 0;
  const std::int32_t has_one = (range2 > 1) & finite;
  return has_one != 0 ? bounded : rose.count;
}

PERCEPTION_WIDER void findBearings(const PlacedBlock& placed, std::size_t count, const Rose rose,
                                   std::int32_t* __restrict bearing, float* __restrict range) {
  const float* __restrict x = placed.x.data(), * __restrict y = placed.y.data();
  const std::int32_t* __restrict cell = placed.cell.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - rose.x, dy = y[i] - rose.y, range2 = dx * dx + dy * dy;
    bearing[i] = bearingOf(dx, dy, range2, cell[i] != PlacedBlock::kNotFinite, rose);
    range[i] = range2;
  }
}

// Of points that only clear their bearing is all that matters. Returns how many are no numbers.
PERCEPTION_WIDER std::int32_t findClear(const float* __restrict x, const float* __restrict y,
                                        const float* __restrict z, std::size_t count,
                                        const PointOffset from, const Rose rose,
                                        std::int32_t* __restrict bearing, float* __restrict range) {
  std::int32_t not_finite = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] * from.per_metre + from.x - rose.x;
    const float dy = y[i] * from.per_metre + from.y - rose.y;
    const float sum = x[i] + y[i] + z[i], range2 = dx * dx + dy * dy;
    const std::int32_t finite = sum - sum == 0;
    bearing[i] = bearingOf(dx, dy, range2, finite, rose);
    range[i] = range2, not_finite += 1 - finite;
  }
  return not_finite;
}

// Points that are farther than their bearing's farthest before the block. Mostly none is.
PERCEPTION_WIDER void findFarther(const std::int32_t* __restrict bearing,
                                  const float* __restrict range, std::size_t count,
                                  const float* __restrict farthest, std::uint8_t* __restrict news) {
  for (std::size_t i = 0; i < count; ++i) news[i] = range[i] > farthest[bearing[i]];
}
/// A beam of a block on its way, mirrored so that it grows along.
struct FlatBeam {
  float on, aside, across;  ///< [cells], [cells], [-]
  float from, to;           ///< [cells] along
  std::int32_t column;      ///< of cell and row 0
  std::int32_t step, side;  ///< from column to column along and aside
  std::int32_t cells;       ///< of the window
};

// Lanes beyond its end stay in its last cell.
PERCEPTION_LANES void crossOne(const FlatBeam& beam, std::uint8_t* crossed) {
  const Float8 from = eight(beam.from), to = eight(beam.to);
  const auto first = static_cast<std::int32_t>(beam.on + beam.from);
  const auto last = std::min(static_cast<std::int32_t>(beam.on + beam.to), beam.cells - 1);
  for (std::int32_t i = first; i <= last; i += kLanes) {
    const Int8 along = smaller(i + firstEight(), eight(last));
    const Float8 begin = asFloats(along) - beam.on;
    const Int8 row0 = truncated(beam.aside + beam.across * larger(begin, from));
    const Int8 row1 = truncated(beam.aside + beam.across * smaller(begin + 1, to));
    std::int32_t enters[kLanes], leaves[kLanes];
    store8(beam.column + along * beam.step + row0 * beam.side, enters);
    store8(beam.column + along * beam.step + row1 * beam.side, leaves);
    for (int k = 0; k < kLanes; ++k) crossed[enters[k]] = 1, crossed[leaves[k]] = 1;
  }
}

PERCEPTION_WIDER void crossAll(const BeamBlock& b, const WindowPlace origin, std::int32_t cells,
                               std::uint8_t* crossed) {
  for (std::size_t i = 0; i < b.count; ++i) {
    if (!(b.from[i] < b.to[i])) continue;
    const bool along_x = b.face[i] < 2, back = b.face[i] % 2 != 0;
    const float on = along_x ? origin.x : origin.y;
    const std::int32_t step = along_x ? 1 : cells;
    crossOne({back ? static_cast<float>(cells) - on : on, along_x ? origin.y : origin.x,
              b.across[i], b.from[i], b.to[i], back ? (cells - 1) * step : 0, back ? -step : step,
              along_x ? cells : 1, cells},
             crossed);
  }
}

}  // namespace

FlatBeams::FlatBeams(double step, int cells)
    : bearings_(static_cast<std::size_t>(std::ceil(kTwoPi / step))),
      nearest_(bearings_ + 1),
      farthest_(bearings_ + 1),
      stops_(bearings_ + 1),
      ends_(bearings_ + 1),
      per_radian_(static_cast<float>(static_cast<double>(bearings_) / kTwoPi)),
      cells_(cells) {}

void FlatBeams::begin(const WindowPlace& origin) {
  std::fill(nearest_.begin(), nearest_.end(), kNone);
  std::fill(farthest_.begin(), farthest_.end(), 0.0F);
  origin_ = origin, origin_.z = kMiddle, origin_.low = origin_.high = 1;
}

FlatBeams::Rose FlatBeams::rose() const {
  return {origin_.x, origin_.y, per_radian_, static_cast<std::int32_t>(bearings_)};
}

std::size_t FlatBeams::offerClear(const GridPoints& points, const WindowFrame& frame,
                                  std::uint32_t first) {
  constexpr std::size_t kSize = PlacedBlock::kSize, kGroup = 8;
  std::size_t not_finite = 0;
  for (std::size_t block = 0; block < points.size(); block += kSize) {
    const std::size_t count = std::min(kSize, points.size() - block);
    not_finite += static_cast<std::size_t>(findClear(points.x(block), points.y(block),
                                                     points.z(block), count, frame.offsetOf(points),
                                                     rose(), bearing_.data(), range_.data()));
    std::uint8_t news[kSize] = {};
    findFarther(bearing_.data(), range_.data(), count, farthest_.data(), news);
    for (std::size_t begin = 0; begin < count; begin += kGroup) {
      std::uint64_t any = 0;
      std::memcpy(&any, news + begin, kGroup);
      if (any == 0) continue;
      for (std::size_t k = begin; k < std::min(begin + kGroup, count); ++k) {
        const auto bearing = static_cast<std::size_t>(bearing_[k]);
        if (range_[k] > farthest_[bearing])
          farthest_[bearing] = range_[k],
          ends_[bearing] = first + static_cast<std::uint32_t>(block + k);
      }
    }
  }
  return not_finite;
}

// Of neighbouring returns either may be the nearer one: no branches.
void FlatBeams::offerHits(const PlacedBlock& placed, const std::int32_t* stops, std::size_t count,
                          std::uint32_t first) {
  findBearings(placed, count, rose(), bearing_.data(), range_.data());
  bool all_stop = true;
  for (std::size_t k = 0; k < count; ++k) {
    const auto bearing = static_cast<std::size_t>(bearing_[k]);
    const float range = stops[k] != 0 ? range_[k] : kNone, nearest = nearest_[bearing];
    const bool nearer = range < nearest;
    nearest_[bearing] = nearer ? range : nearest;
    stops_[bearing] = nearer ? first + static_cast<std::uint32_t>(k) : stops_[bearing];
    all_stop &= stops[k] != 0;
  }
  if (all_stop) return;
  for (std::size_t k = 0; k < count; ++k) {
    const auto bearing = static_cast<std::size_t>(bearing_[k]);
    if (stops[k] == 0 && range_[k] > farthest_[bearing])
      farthest_[bearing] = range_[k], ends_[bearing] = first + static_cast<std::uint32_t>(k);
  }
}

void FlatBeams::crossBlock(std::uint8_t* crossed) {
  block_.prepare(origin_, cells_, 1, {});
  crossAll(block_, origin_, cells_, crossed);
  block_.count = 0;
}

}  // namespace perception
