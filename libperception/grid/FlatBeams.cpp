#include "libperception/grid/FlatBeams.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/Angle.h"
#include "libperception/core/RoughBearing.h"
#include "libperception/core/Wider.h"

namespace perception {
namespace {

/// Where directions begin and how many there are.
struct Rose {
  float x, y;  ///< [cells]
  float per_radian;
  std::int32_t count;
};

PERCEPTION_WIDER void findBearings(const float* __restrict x, const float* __restrict y,
                                   std::size_t count, Rose rose, std::int32_t* __restrict bearing,
                                   float* __restrict range) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - rose.x, dy = y[i] - rose.y, range2 = dx * dx + dy * dy;
    const auto bin = static_cast<std::int32_t>((roughBearing(dx, dy) + 3.1416F) * rose.per_radian);
    const std::int32_t bounded = bin < rose.count ? bin : 0;
    bearing[i] = range2 > 1 ? bounded : -1;
    range[i] = range2;
  }
}

}  // namespace

FlatBeams::FlatBeams(double step)
    : beams_(static_cast<std::size_t>(std::ceil(kTwoPi / step))),
      per_radian_(static_cast<float>(static_cast<double>(beams_.size()) / kTwoPi)) {}

void FlatBeams::begin(const WindowPlace& origin) {
  std::fill(beams_.begin(), beams_.end(), Beam{});
  origin_ = origin;
}

void FlatBeams::look(const PlacedBlock& placed, std::size_t count) {
  float ranges[PlacedBlock::kSize];
  findBearings(placed.x.data(), placed.y.data(), count,
               {origin_.x, origin_.y, per_radian_, static_cast<std::int32_t>(beams_.size())},
               bearing_.data(), ranges);
  std::memcpy(range_.data(), ranges, count * sizeof(float));
}

}  // namespace perception
