#include "libperception/lidar/classification/LeafMasks.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

using Node = BoostedTrees::Node;

/// Values on a coarse grid, so that many are equal to a threshold.
float coarse(Rng& rng) { return static_cast<float>(rng.below(9)) - 4; }

/// Appends a tree that grows at a random leaf until it has so many.
void addTree(BoostedTrees& trees, std::size_t leaves, Rng& rng) {
  const auto root = static_cast<std::int32_t>(trees.nodes.size());
  trees.roots.push_back(root);
  trees.nodes.push_back({-1, static_cast<float>(rng.normal()), 0, 0});
  std::vector<std::int32_t> ends = {root};
  while (ends.size() < leaves) {
    const std::size_t k = rng.below(static_cast<std::uint32_t>(ends.size()));
    const auto left = static_cast<std::int32_t>(trees.nodes.size());
    for (int side = 0; side < 2; ++side)
      trees.nodes.push_back({-1, static_cast<float>(rng.normal()), 0, 0});
    trees.nodes[static_cast<std::size_t>(ends[k])] = {
        static_cast<std::int16_t>(rng.below(kFeatures)), coarse(rng), left, left + 1};
    ends[k] = left;
    ends.push_back(left + 1);
  }
}

BoostedTrees treesOf(std::size_t leaves, std::size_t count, Rng& rng) {
  BoostedTrees trees;
  for (double& b : trees.base) b = rng.normal();
  for (std::size_t t = 0; t < count; ++t) addTree(trees, leaves, rng);
  return trees;
}

TEST(LeafMasks, GiveTheScoresOfTheTreesToTheBit) {
  Rng rng(RngKey{1, 0, 0, 3});
  for (const std::size_t leaves : {1, 2, 12, 16}) {
    const BoostedTrees trees = treesOf(leaves, 100 * kClusterKinds, rng);
    const auto masks = LeafMasks::of(trees);
    ASSERT_TRUE(masks) << leaves;
    for (int i = 0; i < 200; ++i) {
      Descriptor d;
      for (float& v : d) v = coarse(rng);
      d[rng.below(kFeatures)] = std::numeric_limits<float>::infinity();
      d[rng.below(kFeatures)] = -std::numeric_limits<float>::infinity();
      d[rng.below(kFeatures)] = std::numeric_limits<float>::quiet_NaN();
      double expected[kClusterKinds], scores[kClusterKinds];
      trees.scores(d, expected);
      masks->scores(d, scores);
      for (std::size_t k = 0; k < kClusterKinds; ++k) EXPECT_EQ(scores[k], expected[k]) << leaves;
    }
  }
}

TEST(LeafMasks, AreNotMadeOfTreesWithMoreLeavesThanBits) {
  Rng rng(RngKey{2, 0, 0, 3});
  EXPECT_FALSE(LeafMasks::of(treesOf(LeafMasks::kMostLeaves + 1, kClusterKinds, rng)));
}

}  // namespace
}  // namespace perception
