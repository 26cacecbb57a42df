#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// A partition of points: points of one group have the same number, counted in the order of the
/// groups' first points.
struct Partition {
  std::vector<std::uint32_t> group;  ///< per point
  std::uint32_t count = 0;           ///< of groups
};

/// Exact single linkage of the plane's points at two thresholds at once: the connected components
/// of the graph that joins points no farther than a threshold apart.
struct DoubleLinkage {
  Partition near;  ///< at the small threshold
  /// At the large one every group is a union of groups of `near`.
  std::uint32_t far_count = 0;
  std::vector<std::uint32_t> far_of_near;  ///< the far group of each near group
  std::vector<std::uint32_t>
      parts;  ///< near groups in each far group; 1: the same set at both thresholds
};

/// The far group of every point, numbered in the order of the groups' first points.
Partition farPartition(const DoubleLinkage& linkage);

/// `near_threshold` < `far_threshold` [m]; coordinates finite. Distances are compared as squares in
/// float.
DoubleLinkage linkTwice(const std::vector<float>& x, const std::vector<float>& y,
                        double near_threshold, double far_threshold);

}  // namespace perception
