#include "libperception/simulation/weather/AzimuthTable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

TEST(AzimuthTable, KnowsAllThatARayMeets) {
  const Vector2 eye(3, -2);
  AzimuthTable table;
  table.reset(eye);
  struct Disk {
    Vector2 place;
    double radius;
  };
  std::vector<Disk> disks;
  Rng rng({1, 0, 0, 0});
  for (std::uint32_t i = 0; i < 300; ++i) {
    disks.push_back({{rng.uniform(-20, 20), rng.uniform(-20, 20)}, rng.uniform(0.05, 3)});
    table.add(disks.back().place, disks.back().radius, i);
  }
  std::size_t met = 0, listed = 0;
  for (int k = 0; k < 3600; ++k) {
    const double azimuth = radians(-180 + 0.1 * k);
    const Vector2 ray(std::cos(azimuth), std::sin(azimuth));
    const auto& items = table.along({ray.x(), ray.y(), -0.3});
    listed += items.size();
    for (std::uint32_t i = 0; i < disks.size(); ++i) {
      const Vector2 arm = disks[i].place - eye;
      const double along = std::max(0.0, arm.dot(ray));
      if ((arm - along * ray).norm() > disks[i].radius) continue;
      ++met;
      EXPECT_NE(std::find(items.begin(), items.end(), i), items.end()) << i << " at " << azimuth;
    }
  }
  EXPECT_LT(listed, 2 * met) << "few others are named";
  table.reset(eye);
  EXPECT_TRUE(table.along({1, 0, 0}).empty());
}

}  // namespace
}  // namespace perception
