#include "libperception/lidar/linkage/Forest.h"

namespace perception {

Partition partitionOf(const std::vector<std::uint32_t>& cell_of_point, Forest& cells) {
  constexpr std::uint32_t kNone = ~0u;
  Partition partition;
  partition.group.resize(cell_of_point.size());
  std::vector<std::uint32_t> number(cells.size(), kNone), root(cells.size());
  for (std::uint32_t k = 0; k < cells.size(); ++k) root[k] = cells.find(k);
  for (std::size_t i = 0; i < cell_of_point.size(); ++i) {
    std::uint32_t& n = number[root[cell_of_point[i]]];
    if (n == kNone) n = partition.count++;
    partition.group[i] = n;
  }
  return partition;
}

void joinNearGroups(Forest& near_groups, DoubleLinkage& linkage) {
  linkage.far_of_near.resize(linkage.near.count);
  for (std::uint32_t g = 0; g < linkage.near.count; ++g) {
    // Near groups are in the order of their first points and roots are the smallest: far groups are
    // in that order, too.
    const std::uint32_t root = near_groups.find(g);
    linkage.far_of_near[g] = root == g ? linkage.far_count++ : linkage.far_of_near[root];
  }
  linkage.parts.assign(linkage.far_count, 0);
  for (const std::uint32_t far : linkage.far_of_near) ++linkage.parts[far];
}

}  // namespace perception
