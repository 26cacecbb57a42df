#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/lidar/linkage/Linkage.h"

namespace perception {

/// Disjoint sets (union-find) with path halving; the smaller root becomes the parent, so that roots
/// do not depend on the order of unions.
class Forest {
 public:
  explicit Forest(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  std::size_t size() const { return parent_.size(); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    i = find(i), j = find(j);
    if (i < j) parent_[j] = i;
    if (j < i) parent_[i] = j;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Groups of points by the sets of their cells, numbered in the order of the groups' first points.
Partition partitionOf(const std::vector<std::uint32_t>& cell_of_point, Forest& cells);

/// Computes the far groups of a linkage from the sets of its near groups.
void joinNearGroups(Forest& near_groups, DoubleLinkage& linkage);

}  // namespace perception
