#pragma once
#include <cmath>
#include <cstddef>

#include "libperception/weather/PointFilter.h"

namespace perception {

/// Range [m] of a return from its sensor.
inline double rangeOf(const LidarCloud& cloud, std::size_t i) {
  return std::hypot(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                    static_cast<double>(cloud.z[i]));
}

/// For filters that say yes or no: trust 0 for every return of which `isPhantom(i)`, 1 for others.
template <class Verdict>
TrustStats judge(LidarCloud& cloud, const Verdict& isPhantom) {
  TrustStats stats;
  stats.returns = cloud.size();
  cloud.trust.assign(cloud.size(), 1);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isPhantom(i)) continue;
    cloud.trust[i] = 0;
    ++stats.phantoms;
  }
  return stats;
}

}  // namespace perception
