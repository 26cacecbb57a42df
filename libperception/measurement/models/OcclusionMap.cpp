#include "libperception/measurement/models/OcclusionMap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {

OcclusionMap::OcclusionMap(const Vector2& origin, std::size_t bins)
    : origin_(origin), nearest_(bins, std::numeric_limits<float>::infinity()) {}

std::size_t OcclusionMap::binOf(double bearing) const {
  const double turns = bearing / kTwoPi - std::floor(bearing / kTwoPi);
  return std::min(static_cast<std::size_t>(turns * static_cast<double>(nearest_.size())),
                  nearest_.size() - 1);
}

void OcclusionMap::add(const Vector2& point) {
  const Vector2 d = point - origin_;
  float& nearest = nearest_[binOf(std::atan2(d.y(), d.x()))];
  nearest = std::min(nearest, static_cast<float>(d.norm()));
}

double OcclusionMap::nearest(double bearing) const {
  return static_cast<double>(nearest_[binOf(bearing)]);
}

double OcclusionMap::visibility(double bearing_cw, double bearing_ccw, double range,
                                double tolerance) const {
  const double step = kTwoPi / static_cast<double>(nearest_.size());
  const double span =
      bearing_ccw - bearing_cw - kTwoPi * std::floor((bearing_ccw - bearing_cw) / kTwoPi);
  const int directions = 1 + static_cast<int>(span / step);
  int open = 0;
  for (int i = 0; i < directions; ++i) {
    const double bearing = bearing_cw + span * (i + 0.5) / directions;
    if (nearest(bearing) >= range - tolerance) ++open;
  }
  return static_cast<double>(open) / directions;
}

}  // namespace perception
