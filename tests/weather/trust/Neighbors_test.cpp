#include "libperception/weather/trust/Neighbors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr NeighborRules kRules{20, 0.02F, 0.04F, 0.1F, 6};

/// 40 rows of beams at ranges that jump, a third of them with a second echo in the same direction,
/// some of these twice the same.
LidarCloud cloudOfEchoes() {
  LidarCloud cloud;
  Rng random({5, 0, 0, 0});
  const auto add = [&cloud](double azimuth, double slope, double flat) {
    cloud.x.push_back(static_cast<float>(flat * std::cos(azimuth)));
    cloud.y.push_back(static_cast<float>(flat * std::sin(azimuth)));
    cloud.z.push_back(static_cast<float>(flat * slope));
  };
  for (int column = 0; column < 600; ++column)
    for (int row = 0; row < 40; ++row) {
      const double azimuth = radians(column * 0.6 - 179.9), slope = radians(row * 0.5 - 12.2);
      const double range = 10 + random.uniform(0, 1) + (random.uniform(0, 1) < 0.3 ? 15 : 0);
      if (random.uniform(0, 1) < 0.3) {
        const double nearer = random.uniform(1, 10);
        add(azimuth, slope, nearer);
        if (random.uniform(0, 1) < 0.5) add(azimuth, slope, nearer);
      }
      add(azimuth, slope, range);
    }
  return cloud;
}

/// Literally: every pixel about a return by itself.
std::uint32_t literalCounts(const RangeImage& image, std::uint32_t pixel, float r) {
  constexpr int kBits = NeighborCounts::kBits;
  std::uint32_t bits = 0;
  for (int row = -RangeImage::kRowReach; row <= RangeImage::kRowReach; ++row)
    for (int column = -RangeImage::kColumnReach; column <= RangeImage::kColumnReach; ++column) {
      if (row == 0 && column == 0) continue;
      const float other = image.pixels()[static_cast<std::size_t>(
          static_cast<std::ptrdiff_t>(pixel) + row * image.stride() + column)];
      const bool same = std::abs(other - r) < kRules.tight * r + 0.03F;
      bits += same;
      bits += static_cast<std::uint32_t>(std::abs(other - r) < kRules.wide * r + 0.03F) << kBits;
      bits += static_cast<std::uint32_t>(other > (1 + kRules.beyond) * r + 0.3F) << 2 * kBits;
      bits += static_cast<std::uint32_t>(other > 0) << 3 * kBits;
      if (std::abs(row) <= 1 && std::abs(column) <= 1)
        bits += static_cast<std::uint32_t>(same) << 4 * kBits;
    }
  return bits;
}

TEST(NeighborCounter, CountsAsALiteralLoopDoesAlsoForEchoesThatTheImageDoesNotShow) {
  const LidarCloud cloud = cloudOfEchoes();
  RangeImage image(radians(0.6), radians(0.5));
  SurroundingCubes cubes(kRules.far);
  SuspectReturns near;
  const std::vector<std::uint32_t> bins(RangeImage::kBlock, 3);
  image.fill(cloud, [&](const RangeImage::Block& block) {
    near.add(cloud, block, bins.data(), HeightAboveGround(Pose3::Identity(), {}), kRules.far,
             cubes);
  });
  near.makeRoomForResults();
  NeighborCounter counter;
  counter.count(image, kRules, near);
  ASSERT_GT(near.count, 10000U);
  std::size_t hidden = 0;
  for (std::size_t s = 0; s < near.count; ++s) {
    ASSERT_EQ(near.neighbors[s], literalCounts(image, near.pixel[s], near.range[s])) << s;
    EXPECT_EQ(near.binOf(s), 3U);
    hidden += image.pixels()[near.pixel[s]] != near.range[s];
  }
  EXPECT_GT(hidden, 3000U);
}

TEST(RangeImage, HoldsNothingOfAScanThatReachedToOtherColumns) {
  LidarCloud ahead;
  for (int i = 0; i < 100; ++i) {
    const float turn = 0.01F * static_cast<float>(i);
    ahead.x.push_back(9 * std::cos(turn)), ahead.y.push_back(9 * std::sin(turn));
    ahead.z.push_back(0);
  }
  RangeImage image(radians(0.6), radians(0.5)), fresh(radians(0.6), radians(0.5));
  image.fill(cloudOfEchoes());
  image.fill(ahead), fresh.fill(ahead);
  EXPECT_EQ(image.pixels(), fresh.pixels());
  EXPECT_EQ(image.firstColumn(), fresh.firstColumn());
  EXPECT_LT(image.lastColumn() - image.firstColumn(), image.columns() / 4);
  image.fill(LidarCloud()), fresh = RangeImage(radians(0.6), radians(0.5));
  fresh.fill(LidarCloud());
  EXPECT_EQ(image.pixels(), fresh.pixels());
}

TEST(SurroundingCubes, HoldNothingOfTheScanBeforeTheyWereCleared) {
  constexpr float kReach = 20;
  constexpr std::size_t kCount = 300;
  std::vector<float> x, y, z;
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto turn = static_cast<float>(i) * 0.7F;
    x.push_back(0.07F * static_cast<float>(i) * std::cos(turn));
    y.push_back(0.07F * static_cast<float>(i) * std::sin(turn));
    z.push_back(static_cast<float>(i % 12) - 5);
  }
  SurroundingCubes cubes(kReach);
  std::vector<std::uint32_t> cube(kCount), corner(kCount);
  cubes.locate(x.data(), y.data(), z.data(), kCount, cube.data(), corner.data());
  for (int scan = 0; scan < 2; ++scan) {
    cubes.add(cube.data(), kCount, ~0U);
    for (std::size_t i = 0; i < kCount; i += 3) cubes.doubt(cube[i]);
    bool any = false;
    for (const std::uint32_t at : corner) any = any || cubes.surroundings(at, false) != 0;
    EXPECT_TRUE(any);
    cubes.clear();
    for (const std::uint32_t at : corner) EXPECT_EQ(cubes.surroundings(at, false), 0);
  }
}

TEST(SuspectReturns, ThoseOfASurfaceAreCleared) {
  SuspectReturns suspects;
  LidarCloud cloud;
  for (int i = 0; i < 100; ++i)
    cloud.x.push_back(5 + 0.1F * static_cast<float>(i)), cloud.y.push_back(1), cloud.z.push_back(0);
  RangeImage image(radians(0.2), radians(0.5));
  SurroundingCubes cubes(20);
  const std::vector<std::uint32_t> bins(RangeImage::kBlock, 0);
  image.fill(cloud, [&](const RangeImage::Block& block) {
    suspects.add(cloud, block, bins.data(), HeightAboveGround(Pose3::Identity(), {}), 20, cubes);
  });
  ASSERT_EQ(suspects.count, 100U);
  suspects.makeRoomForResults();
  for (std::size_t s = 0; s < 100; ++s)
    suspects.neighbors[s] = (s % 3 == 0 ? 6U : 5U) << 4 * NeighborCounts::kBits;
  suspects.clearSurfaces(6);
  ASSERT_EQ(suspects.count, 66U);
  for (std::size_t s = 0; s < suspects.count; ++s) {
    EXPECT_NE(suspects.index[s] % 3, 0U);
    EXPECT_FLOAT_EQ(suspects.range[s], std::hypot(cloud.x[suspects.index[s]], 1.0F));
  }
}

}  // namespace
}  // namespace perception
