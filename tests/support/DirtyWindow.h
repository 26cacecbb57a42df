#pragma once
#include <cmath>
#include <cstdint>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::test {

/// A lidar 1.8 m above a flat road; `dirty` of the patches of 2 deg on its window return nothing.
inline LidarCloud road(double dirty) {
  LidarCloud cloud;
  for (int step = 0; step < 1800; ++step) {
    for (int beam = 0; beam < 40; ++beam) {
      const double a = step * 0.2 - 179.9, e = -24.3 + 0.42 * beam;
      Rng patch({1, static_cast<std::uint64_t>((a + 180) / 2),
                 static_cast<std::uint32_t>((e + 90) / 2), 0});
      if (patch.uniform() < dirty) continue;
      const double range = 1.8 / std::sin(radians(-e));
      const Vector3 p =
          range * Vector3(std::cos(radians(e)) * std::cos(radians(a)),
                          std::cos(radians(e)) * std::sin(radians(a)), std::sin(radians(e)));
      cloud.x.push_back(static_cast<float>(p.x())), cloud.y.push_back(static_cast<float>(p.y()));
      cloud.z.push_back(static_cast<float>(p.z()));
    }
  }
  return cloud;
}

}  // namespace perception::test
