#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// A partition of points into groups, numbered in the order of their first points.
struct Partition {
  std::vector<std::uint32_t> group;  ///< per point
  std::uint32_t count = 0;           ///< of groups
};

/// Exact single linkage of points in the plane at two thresholds: the connected components of the
/// graph whose edges join points not farther apart than the threshold.
struct DoubleLinkage {
  Partition near;  ///< at the small threshold
  /// Number of groups at the large threshold, each a union of groups of `near`.
  std::uint32_t far_count = 0;
  std::vector<std::uint32_t> far_of_near;  ///< the far group of each near group
  std::vector<std::uint32_t>
      parts;  ///< number of near groups in each far group; 1: the same set at both thresholds
};

/// Single linkage of finite points [m]; `near_threshold` < `far_threshold` [m]. Squared distances
/// are compared in float.
DoubleLinkage linkTwice(const std::vector<float>& x, const std::vector<float>& y,
                        double near_threshold, double far_threshold);

}  // namespace perception
