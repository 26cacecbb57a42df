#include "libperception/lidar/classification/LeafMasks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

PERCEPTION_WIDER void clearLeaves(const std::uint16_t* __restrict kept, std::size_t trees,
                                  std::uint16_t* __restrict left) {
#pragma GCC unroll 4
  for (std::size_t t = 0; t < trees; ++t) left[t] &= kept[t];
}

}  // namespace

std::optional<LeafMasks> LeafMasks::of(const BoostedTrees& trees) {
  LeafMasks masks;
  masks.base_ = trees.base;
  masks.trees_ = trees.roots.size() / kClusterKinds * kClusterKinds;
  if (masks.trees_ > std::numeric_limits<std::uint16_t>::max()) return std::nullopt;
  masks.leaf_.assign(masks.trees_ * kMostLeaves, 0);
  Gathered gathered;
  for (std::size_t t = 0; t < masks.trees_; ++t) {
    std::size_t leaves = 0;
    if (!masks.addNode(trees, trees.roots[t], static_cast<std::uint16_t>(t), leaves, gathered))
      return std::nullopt;
  }
  masks.sort(gathered);
  return masks;
}

/// Adds a node and what is below it, leaves from left to right. False: they are too many.
bool LeafMasks::addNode(const BoostedTrees& trees, std::int32_t index, std::uint16_t tree,
                        std::size_t& leaves, Gathered& gathered) {
  const BoostedTrees::Node& node = trees.nodes[static_cast<std::size_t>(index)];
  if (node.feature < 0) {
    if (leaves == kMostLeaves) return false;
    leaf_[tree * kMostLeaves + leaves++] = node.threshold;
    return true;
  }
  const std::size_t first = leaves;
  if (!addNode(trees, node.left, tree, leaves, gathered)) return false;
  const auto on_left = static_cast<Mask>((1u << leaves) - (1u << first));
  gathered[static_cast<std::size_t>(node.feature)].push_back(
      {node.threshold, tree, static_cast<Mask>(~on_left)});
  return addNode(trees, node.right, tree, leaves, gathered);
}

void LeafMasks::sort(Gathered& gathered) {
  for (std::size_t f = 0; f < kFeatures; ++f) {
    std::vector<Split>& splits = gathered[f];
    std::sort(splits.begin(), splits.end(),
              [](const Split& a, const Split& b) { return a.threshold < b.threshold; });
    first_[f] = static_cast<std::uint32_t>(splits_.size());
    splits_.insert(splits_.end(), splits.begin(), splits.end());
    splits_.push_back({std::numeric_limits<float>::infinity(), 0, static_cast<Mask>(~0u)});
    first_left_[f] = left_.size();
    std::vector<Mask> left(trees_, static_cast<Mask>(~0u));
    for (std::size_t k = 0; k < splits.size(); ++k) {
      left[splits[k].tree] &= splits[k].kept;
      if (k % kGroup == kGroup - 1) left_.insert(left_.end(), left.begin(), left.end());
    }
  }
  first_[kFeatures] = static_cast<std::uint32_t>(splits_.size());
}

void LeafMasks::scores(const Descriptor& descriptor, double (&out)[kClusterKinds]) const {
  thread_local std::vector<Mask> left;  // leaves of each tree
  left.assign(trees_, static_cast<Mask>(~0u));
  for (std::size_t f = 0; f < kFeatures; ++f) {
    // What is no number goes right.
    const float value =
        std::isnan(descriptor[f]) ? std::numeric_limits<float>::infinity() : descriptor[f];
    const Split *const first = &splits_[first_[f]], *const end = splits_.data() + first_[f + 1];
    const Split* s = first;
    while (s + kGroup < end && value > s[kGroup - 1].threshold) s += kGroup;
    if (s != first) {
      const std::size_t group = static_cast<std::size_t>(s - first) / kGroup - 1;
      clearLeaves(&left_[first_left_[f] + group * trees_], trees_, left.data());
    }
    for (; value > s->threshold; ++s) left[s->tree] &= s->kept;
  }
  for (std::size_t k = 0; k < kClusterKinds; ++k) out[k] = base_[k];
  for (std::size_t t = 0; t < trees_; t += kClusterKinds) {
    for (std::size_t k = 0; k < kClusterKinds; ++k) {
      const auto leaf = static_cast<std::size_t>(__builtin_ctz(left[t + k]));
      out[k] += static_cast<double>(leaf_[(t + k) * kMostLeaves + leaf]);
    }
  }
}

}  // namespace perception
