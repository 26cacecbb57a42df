#include "libperception/lidar/linkage/SpaceLinkage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

using Returns = std::vector<LinkedReturn>;

bool linked(const LinkedReturn& a, const LinkedReturn& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z, l = std::min(a.length, b.length);
  return x * x + y * y + z * z <= l * l;
}

/// Connected components by looking at every pair.
Partition everyPair(const Returns& returns) {
  std::vector<std::uint32_t> root(returns.size());
  std::iota(root.begin(), root.end(), 0u);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < root.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (root[i] == root[j] || !linked(returns[i], returns[j])) continue;
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

/// Blobs about the origin, some of which touch; link lengths between the bounds.
Returns randomReturns(std::uint64_t seed, std::size_t count, double side, double least,
                      double most) {
  Rng rng(RngKey{seed, 0, 0, 7});
  Returns returns;
  while (returns.size() < count) {
    const double x = rng.uniform(-side, side), y = rng.uniform(-side, side), z = rng.uniform(-1, 1),
                 spread = rng.uniform(0.01, 0.7);
    for (int k = 0; k < 12; ++k)
      returns.push_back({static_cast<float>(rng.normal(x, spread)),
                         static_cast<float>(rng.normal(y, spread)),
                         static_cast<float>(rng.normal(z, spread)),
                         static_cast<float>(rng.uniform(least, most))});
  }
  return returns;
}

struct Lengths {
  double least, most;
};

TEST(SpaceLinkage, EqualsEveryPair) {
  for (const Lengths l : {Lengths{0.3, 0.3}, {0.3, 0.5}, {0.18, 0.3}, {0.1, 1.0}}) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      // From one crowd to a hundred columns of cubes.
      const Returns returns =
          randomReturns(seed, 240, 1 + static_cast<double>(seed), l.least, l.most);
      const Partition expected = everyPair(returns);
      const Partition found =
          linkInSpace(returns, static_cast<float>(l.least), static_cast<float>(l.most));
      ASSERT_EQ(found.count, expected.count) << l.most << ", " << seed;
      ASSERT_EQ(found.group, expected.group) << l.most << ", " << seed;
    }
  }
}

TEST(SpaceLinkage, EqualsEveryPairOnALatticeAtTheLinkLength) {
  // Every neighbor lies exactly at, or just above, the link length.
  for (const float pitch : {0.5f, std::nextafter(0.5f, 1.0f)}) {
    Returns returns;
    for (int i = -4; i < 4; ++i)
      for (int j = -4; j < 4; ++j)
        for (int k = 0; k < 3; ++k)
          returns.push_back({static_cast<float>(i) * pitch, static_cast<float>(j) * pitch,
                             static_cast<float>(k) * pitch, 0.5f});
    const Partition found = linkInSpace(returns, 0.25f, 0.5f);
    EXPECT_EQ(found.count == 1, pitch == 0.5f);
    EXPECT_EQ(found.group, everyPair(returns).group) << pitch;
  }
}

TEST(SpaceLinkage, TheSmallerLinkLengthOfTwoReturnsCounts) {
  const auto groups = [](float a, float b) {
    return linkInSpace({{0, 0, 0, a}, {0.4f, 0, 0, b}}, 0.3f, 0.5f).count;
  };
  EXPECT_EQ(groups(0.5f, 0.5f), 1u);
  EXPECT_EQ(groups(0.3f, 0.5f), 2u);
  EXPECT_EQ(groups(0.5f, 0.3f), 2u);
}

TEST(SpaceLinkage, HeightSeparatesAsTheGroundPlaneDoes) {
  EXPECT_EQ(linkInSpace({{0, 0, 0, 0.3f}, {0, 0, 0.29f, 0.3f}}, 0.3f, 0.3f).count, 1u);
  EXPECT_EQ(linkInSpace({{0, 0, 0, 0.3f}, {0, 0, 0.31f, 0.3f}}, 0.3f, 0.3f).count, 2u);
}

TEST(SpaceLinkage, GroupsAreNumberedByTheirFirstReturns) {
  const Returns returns = {{9, 0, 0, 0.3f}, {-9, 0, 0, 0.3f}, {9, 0.2f, 0, 0.3f}, {0, 0, 0, 0.3f}};
  EXPECT_EQ(linkInSpace(returns, 0.3f, 0.3f).group, (std::vector<std::uint32_t>{0, 1, 0, 2}));
}

TEST(SpaceLinkage, NoReturnsHaveNoGroups) {
  const Partition none = linkInSpace({}, 0.3f, 0.5f);
  EXPECT_EQ(none.count, 0u);
  EXPECT_TRUE(none.group.empty());
}

TEST(SpaceLinkage, TheOrderOfReturnsChangesOnlyTheNumbers) {
  const Returns returns = randomReturns(5, 300, 4, 0.3, 0.5);
  const Partition first = linkInSpace(returns, 0.3f, 0.5f);
  std::vector<std::size_t> order(returns.size());
  std::iota(order.begin(), order.end(), 0u);
  Rng rng(RngKey{6, 0, 0, 7});
  std::shuffle(order.begin(), order.end(), rng);
  Returns shuffled;
  for (const std::size_t i : order) shuffled.push_back(returns[i]);
  const Partition second = linkInSpace(shuffled, 0.3f, 0.5f);
  ASSERT_EQ(second.count, first.count);
  ASSERT_GT(first.count, 3u);
  std::vector<std::uint32_t> number(first.count, ~0u);  // of each first group among the second
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::uint32_t& n = number[first.group[order[k]]];
    if (n == ~0u) n = second.group[k];
    ASSERT_EQ(n, second.group[k]);
  }
}

}  // namespace
}  // namespace perception
