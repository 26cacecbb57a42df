#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/lidar/classification/ClusterClassifier.h"

namespace perception {

/// Boosted trees of few leaves in the order of their features [lucchese2015]: a tree's leaves are
/// bits, a split whose feature is above its threshold clears those on its left, and the lowest bit
/// that is left is the leaf. Splits of a feature are looked at up to the first that is not
/// exceeded, without a branch for each node; those of a whole group clear their leaves at once. The
/// sums are those of BoostedTrees::scores(), to the bit.
class LeafMasks {
 public:
  static constexpr std::size_t kMostLeaves = 16;  ///< of a tree: bits of a mask

  /// Nothing for trees that have more leaves than that.
  static std::optional<LeafMasks> of(const BoostedTrees& trees);
  /// As BoostedTrees::scores().
  void scores(const Descriptor& descriptor, double (&out)[kClusterKinds]) const;

 private:
  using Mask = std::uint16_t;
  static constexpr std::size_t kGroup = 32;  ///< splits (measured: as few instructions as 16 or 64)
  struct Split {
    float threshold;
    std::uint16_t tree;
    Mask kept;  ///< leaves that are left where the feature is above the threshold
  };

  using Gathered = std::array<std::vector<Split>, kFeatures>;  // by feature

  bool addNode(const BoostedTrees& trees, std::int32_t index, std::uint16_t tree,
               std::size_t& leaves, Gathered& gathered);
  void sort(Gathered& gathered);

  std::array<double, kClusterKinds> base_{};
  std::size_t trees_ = 0;
  std::vector<float> leaf_;    ///< kMostLeaves of each tree, from the left
  std::vector<Split> splits_;  ///< of each feature: by threshold, and one that nothing exceeds
  /// In `splits_`, of each feature, and the end.
  std::array<std::uint32_t, kFeatures + 1> first_{};
  /// After each group of splits of a feature: leaves of all trees that are left by those up to it.
  std::vector<Mask> left_;
  std::array<std::size_t, kFeatures> first_left_{};  ///< in `left_`, of each feature
};

}  // namespace perception
