#include "libperception/pipeline/WindowDirt.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/core/Random.h"

namespace perception {
namespace {

constexpr Stamp kStart{1'577'836'800'000'000'000};

/// A lidar 1.8 m above a flat road; `dirty` of the patches of 2 deg on its window return nothing.
LidarCloud road(double dirty) {
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

TEST(WindowDirt, TheShareIsThatOfThePatches) {
  for (const double dirty : {0.0, 0.1, 0.3}) {
    WindowDirt window;
    for (int k = 0; k <= 12; ++k) window.add(road(dirty), kStart + 0.1 * k);
    ASSERT_TRUE(window.share().has_value());
    EXPECT_NEAR(*window.share(), dirty, 0.06);
  }
}

TEST(WindowDirt, LessThanASecondSaysNothing) {
  WindowDirt window;
  for (int k = 0; k <= 8; ++k) window.add(road(0), kStart + 0.1 * k);
  EXPECT_FALSE(window.share().has_value());
}

TEST(WindowDirt, CountsTheReturnsOfTheRoadOfOneScan) {
  WindowDirt window;
  window.add(road(0), kStart);
  const auto clean = static_cast<double>(window.returns());
  window.add(road(0.3), kStart + 0.1);
  EXPECT_GT(clean, 1000);
  EXPECT_NEAR(static_cast<double>(window.returns()) / clean, 0.7, 0.06);
}

}  // namespace
}  // namespace perception
