#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/lidar/linkage/Linkage.h"

namespace perception {

/// A return to be linked: position [m], its height already weighed, and its link length [m].
struct LinkedReturn {
  float x, y, z;
  float length;
};

/// Exact single linkage in space: the connected components of the graph that joins two returns no
/// farther apart than the smaller of their link lengths. No length is below `least`, none above
/// `most` [m]. Groups are numbered in the order of their first returns.
Partition linkInSpace(const std::vector<LinkedReturn>& returns, float least, float most);

}  // namespace perception
