#pragma once
#include <cmath>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::test {

/// A wall at x = `range` [m] seen by 8 rings, 0.8 deg apart, of 91 beams, 1 deg apart, from -45 to
/// 45 deg.
inline LidarCloud wallCloud(double range, float intensity = 0.3f) {
  LidarCloud cloud;
  cloud.max_range = 120;
  for (int ring = 0; ring < 8; ++ring) {
    for (int i = -45; i <= 45; ++i) {
      const double y = range * std::tan(radians(i)), flat = std::hypot(range, y);
      cloud.x.push_back(static_cast<float>(range));
      cloud.y.push_back(static_cast<float>(y));
      cloud.z.push_back(static_cast<float>(flat * std::tan(radians(0.8 * ring))));
      cloud.intensity.push_back(intensity);
      cloud.ring.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return cloud;
}

/// Without the returns to the right.
inline LidarCloud leftHalf(const LidarCloud& cloud) {
  LidarCloud half;
  half.max_range = cloud.max_range;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.y[i] < 0) continue;
    half.x.push_back(cloud.x[i]), half.y.push_back(cloud.y[i]), half.z.push_back(cloud.z[i]);
    half.intensity.push_back(cloud.intensity[i]), half.ring.push_back(cloud.ring[i]);
  }
  return half;
}

}  // namespace perception::test
