#pragma once
#include "libperception/lidar/linkage/Linkage.h"

namespace perception::test {

/// The far group of every point, numbered in the order of the groups' first points.
inline Partition farPartition(const DoubleLinkage& linkage) {
  Partition far;
  far.count = linkage.far_count;
  far.group.reserve(linkage.near.group.size());
  for (const std::uint32_t near : linkage.near.group)
    far.group.push_back(linkage.far_of_near[near]);
  return far;
}

}  // namespace perception::test
