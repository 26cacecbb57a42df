#include "libperception/measurement/frames/NoReturns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace perception {
namespace {

constexpr int kBeams = 16, kColumns = 360;

/// A scan whose beam and column have this range [m]; NaN: none.
LidarCloud scanOf(const std::function<double(int beam, int column)>& range) {
  LidarCloud cloud;
  for (int beam = 0; beam < kBeams; ++beam) {
    for (int column = 0; column < kColumns; ++column) {
      const double e = radians(2.0 * beam - 15), a = radians(column), r = range(beam, column);
      cloud.x.push_back(static_cast<float>(r * std::cos(e) * std::cos(a)));
      cloud.y.push_back(static_cast<float>(r * std::cos(e) * std::sin(a)));
      cloud.z.push_back(static_cast<float>(r * std::sin(e)));
      cloud.ring.push_back(static_cast<std::uint16_t>(beam));
    }
  }
  return cloud;
}

/// Beams that look down meet the ground, others a wall ahead within 59 deg; else nothing.
double street(int beam, int column, double nothing) {
  const double e = radians(2.0 * beam - 15), a = radians(column);
  if (e < 0) return 1.7 / std::sin(-e);
  return std::cos(a) > 0.51 ? 30 / std::cos(a) / std::cos(e) : nothing;
}

std::size_t nothingIn(const LidarCloud& cloud) { return noReturnsOf(cloud).points.size(); }

TEST(NoReturns, FarPlacesAndTheLimitOfALidarAreFoundWhateverTheyAre) {
  constexpr std::size_t kNothing = 8 * 241;
  for (const double nothing : {1e10, 1e6, 65535.0, 1e30, 262.14, 131.07, 200.0, 120.0, 100.0}) {
    LidarCloud cloud = scanOf([&](int beam, int column) { return street(beam, column, nothing); });
    const NoReturns none = noReturnsOf(cloud);
    EXPECT_EQ(none.points.size(), kNothing) << nothing;
    EXPECT_FALSE(none.elsewhere);
    const LidarCloud before = cloud;
    EXPECT_EQ(clear(none, cloud), kNothing);
    EXPECT_EQ(cloud.ring, before.ring);
    std::size_t left = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!std::isfinite(cloud.x[i])) continue;
      ++left;
      EXPECT_EQ(cloud.x[i], before.x[i]);
    }
    EXPECT_EQ(left, kBeams * kColumns - kNothing);
    EXPECT_EQ(nothingIn(cloud), 0U);
  }
}

TEST(NoReturns, BothKindsInOneScanAreFound) {
  const auto cloud = scanOf(
      [](int beam, int column) { return street(beam, column, column % 2 == 0 ? 1e6 : 150.0); });
  EXPECT_EQ(nothingIn(cloud), 8U * 241U);
}

TEST(NoReturns, RangesRoundedToMillimetersAreAlike) {
  auto cloud = scanOf([](int beam, int column) { return street(beam, column, 200.0); });
  for (auto* values : {&cloud.x, &cloud.y, &cloud.z})
    for (float& v : *values) v = std::round(v * 1000) / 1000;
  EXPECT_EQ(nothingIn(cloud), 8U * 241U);
}

TEST(NoReturns, RealReturnsStay) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  // A wall across the street, a long wall beside it, a tunnel, and a hall that is closed around.
  const std::function<double(int, int)> scenes[] = {
      [&](int beam, int column) { return street(beam, column, nan); },
      [](int beam, int column) {
        const double e = radians(2.0 * beam - 15), a = radians(column);
        return 60 / std::max(0.1, std::abs(std::cos(a))) / std::cos(e);
      },
      [](int, int column) { return 5 / std::max(0.03, std::abs(std::sin(radians(column)))); },
      [](int beam, int column) {
        const double e = radians(2.0 * beam - 15), a = radians(column);
        const double wall = 40 / std::max(std::abs(std::cos(a)), std::abs(std::sin(a)));
        return e < 0 ? std::min(wall, 1.7 / std::sin(-e)) : wall / std::cos(e);
      }};
  for (const auto& scene : scenes) {
    auto cloud = scanOf(scene);
    EXPECT_EQ(nothingIn(cloud), 0U);
    // The same by a lidar that counts in 4 cm.
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const float r = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
      const float scale = std::round(r / 0.04F) * 0.04F / r;
      cloud.x[i] *= scale, cloud.y[i] *= scale, cloud.z[i] *= scale;
    }
    EXPECT_EQ(nothingIn(cloud), 0U);
  }
}

TEST(NoReturns, ASphereAroundTheSensorAndAShortRangeAreNoLimit) {
  EXPECT_EQ(nothingIn(scanOf([](int, int) { return 30; })), 0U);
  EXPECT_EQ(nothingIn(scanOf([](int beam, int) { return beam < 8 ? 3 : 12; })), 0U);
  EXPECT_EQ(nothingIn(scanOf([](int beam, int) { return 30 + 0.01 * (beam % 8); })), 0U);
  EXPECT_EQ(nothingIn(LidarCloud()), 0U);
}

TEST(NoReturns, CoordinatesOfAnotherUnitOrOriginLieElsewhere) {
  auto millimeters = scanOf([](int beam, int column) {
    return 1000 * street(beam, column, std::numeric_limits<double>::quiet_NaN());
  });
  EXPECT_TRUE(noReturnsOf(millimeters).elsewhere);
  for (const double origin : {5000.0, 450000.0, 5.4e6}) {
    auto map = scanOf([](int beam, int column) { return street(beam, column, 50); });
    for (float& x : map.x) x += static_cast<float>(origin);
    EXPECT_TRUE(noReturnsOf(map).elsewhere) << origin;
  }
}

}  // namespace
}  // namespace perception
