#include "libperception/pipeline/safety/RoadHeights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

RoadHeights::RoadHeights(bool backward)
    : ahead_(backward ? -1.0F : 1.0F),
      height_(kRows * kCells, std::numeric_limits<float>::quiet_NaN()) {}

std::vector<float> RoadHeights::along(const Corridor& corridor, std::vector<float>* unseen) const {
  std::vector<float> road(static_cast<std::size_t>(std::max(corridor.max, 0.0)) + 2);
  if (unseen) unseen->assign(road.size(), 0);
  std::size_t known = 0;  // the vehicle stands on the road
  for (std::size_t s = 1; s < road.size(); ++s) {
    float height = std::numeric_limits<float>::quiet_NaN();
    for (const double d : {0.0, 1.0, -1.0}) {
      if (std::isfinite(height)) break;
      const Vector2 p = onArc(corridor, {static_cast<double>(s), d});
      const auto along = static_cast<float>(p.x()) * ahead_;
      const auto across = static_cast<float>(p.y()) + kHalf;
      if (!(along >= 0 && along < kLength && across >= 0 && across < 2 * kHalf)) continue;
      height = height_[static_cast<std::size_t>(along) * kCells + static_cast<std::size_t>(across)];
    }
    const auto since = static_cast<float>(s - known);
    if (unseen && known > 0 && !std::isfinite(height)) (*unseen)[s] = since;
    if (!std::isfinite(height)) continue;
    const float slope = (height - road[known]) / since;
    for (std::size_t k = known + 1; k <= s; ++k)
      road[k] = height - slope * static_cast<float>(s - k);
    known = s;
  }
  std::fill(road.begin() + static_cast<std::ptrdiff_t>(known), road.end(), road[known]);
  return road;
}

}  // namespace perception
