#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/lidar/Linkage.h"

namespace perception {

/// Union-find with path halving; the smaller root wins, so that roots do not depend on the order of
/// unions.
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

/// Groups of points by the trees that their cells belong to, numbered in the order of the groups'
/// first points.
Partition partitionOf(const std::vector<std::uint32_t>& cell_of_point, Forest& cells);

/// Fills the far half of a linkage from the trees of its near groups.
void joinNearGroups(Forest& near_groups, DoubleLinkage& linkage);

}  // namespace perception
