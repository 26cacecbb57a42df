#include "libperception/lidar/linkage/Linkage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libperception/core/math/Random.h"
#include "tests/lidar/linkage/FarPartition.h"

namespace perception {
namespace {

using test::farPartition;

struct Plane {
  std::vector<float> x, y;
};

/// Connected components by looking at every pair.
Partition everyPair(const Plane& p, double threshold) {
  std::vector<std::uint32_t> root(p.x.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto t2 = static_cast<float>(threshold * threshold);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < root.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const float dx = p.x[i] - p.x[j], dy = p.y[i] - p.y[j];
        if (dx * dx + dy * dy > t2 || root[i] == root[j]) continue;
        root[i] = root[j] = std::min(root[i], root[j]);
        changed = true;
      }
  }
  Partition partition;
  std::vector<std::uint32_t> number(root.size(), ~0u);
  for (const std::uint32_t r : root) {
    if (number[r] == ~0u) number[r] = partition.count++;
    partition.group.push_back(number[r]);
  }
  return partition;
}

/// Blobs and lines, about as dense as makes some groups touch.
Plane randomPlane(std::uint64_t seed, std::size_t count, double side) {
  Rng rng(RngKey{seed, 0, 0, 7});
  Plane p;
  while (p.x.size() < count) {
    const double cx = rng.uniform(-side, side), cy = rng.uniform(-side, side),
                 spread = rng.uniform(0.01, 1.5);
    for (int k = 0; k < 12; ++k) {
      p.x.push_back(static_cast<float>(rng.normal(cx, spread)));
      p.y.push_back(static_cast<float>(rng.normal(cy, spread * rng.uniform(0, 1))));
    }
  }
  return p;
}

TEST(Linkage, EqualsEveryPairAtBothThresholds) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Plane p = randomPlane(seed, 400, 4 + static_cast<double>(seed));
    const DoubleLinkage linkage = linkTwice(p.x, p.y, 0.5, 1.0);
    const Partition near = everyPair(p, 0.5), far = everyPair(p, 1.0);
    ASSERT_EQ(linkage.near.count, near.count) << seed;
    ASSERT_EQ(linkage.near.group, near.group) << seed;
    ASSERT_EQ(farPartition(linkage).group, far.group) << seed;
  }
}

TEST(Linkage, EqualsEveryPairOnALatticeAtTheThreshold) {  // every neighbor lies exactly at, or
                                                          // just above, 0.5 m
  for (const float pitch : {0.5f, std::nextafter(0.5f, 1.0f), 0.25f, 0.3535534f}) {
    Plane p;
    for (int i = 0; i < 15; ++i)
      for (int j = 0; j < 15; ++j)
        p.x.push_back(static_cast<float>(i) * pitch), p.y.push_back(static_cast<float>(j) * pitch);
    const DoubleLinkage linkage = linkTwice(p.x, p.y, 0.5, 1.0);
    EXPECT_EQ(linkage.near.group, everyPair(p, 0.5).group) << pitch;
    EXPECT_EQ(farPartition(linkage).group, everyPair(p, 1.0).group) << pitch;
  }
}

TEST(Linkage, FarGroupsAreUnionsOfNearGroups) {
  const Plane p = randomPlane(99, 3000, 30);
  const DoubleLinkage linkage = linkTwice(p.x, p.y, 0.5, 1.0);
  EXPECT_LT(linkage.far_count, linkage.near.count);
  const Partition far = farPartition(linkage);
  for (std::size_t i = 0; i < p.x.size(); ++i)
    ASSERT_EQ(linkage.far_of_near[linkage.near.group[i]], far.group[i]);
  EXPECT_EQ(std::accumulate(linkage.parts.begin(), linkage.parts.end(), 0u), linkage.near.count);
}

TEST(Linkage, DoesNotDependOnTheOrderOfThePoints) {
  const Plane p = randomPlane(5, 1000, 15);
  Plane reversed{{p.x.rbegin(), p.x.rend()}, {p.y.rbegin(), p.y.rend()}};
  const Partition a = linkTwice(p.x, p.y, 0.5, 1.0).near,
                  b = linkTwice(reversed.x, reversed.y, 0.5, 1.0).near;
  ASSERT_EQ(a.count, b.count);
  std::vector<std::uint32_t> b_of_a(a.count, ~0u);
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    std::uint32_t& other = b_of_a[a.group[i]];
    if (other == ~0u) other = b.group[p.x.size() - 1 - i];
    ASSERT_EQ(other, b.group[p.x.size() - 1 - i]);
  }
}

TEST(Linkage, EqualsEveryPairWherePointsSpreadBeyondItsTable) {
  Plane p = randomPlane(11, 300, 12);
  for (std::size_t i = 0; i < p.x.size(); ++i) {  // cells 1024 apart share a place of the table
    const auto turn = static_cast<float>(i % 5);
    p.x[i] += 362.0f * turn, p.y[i] -= 724.0f * turn;
  }
  const DoubleLinkage linkage = linkTwice(p.x, p.y, 0.5, 1.0);
  EXPECT_EQ(linkage.near.group, everyPair(p, 0.5).group);
  EXPECT_EQ(farPartition(linkage).group, everyPair(p, 1.0).group);
}

TEST(Linkage, TakesNoPointsOneAndFarOnes) {
  EXPECT_EQ(linkTwice({}, {}, 0.5, 1.0).near.count, 0u);
  EXPECT_EQ(linkTwice({3}, {4}, 0.5, 1.0).far_count, 1u);
  EXPECT_EQ(linkTwice({-1e6f, 1e6f, 1e6f}, {0, 0, 0}, 0.5, 1.0).near.count, 2u);
}

}  // namespace
}  // namespace perception
