#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A kd-tree over the returns of a scan, for the filters that this project is compared with.
class NeighborTree {
 public:
  explicit NeighborTree(const LidarCloud& cloud);
  ~NeighborTree();

  /// Squared distances [m^2] from a return to its nearest others, ascending; fewer where the scan
  /// has fewer.
  void nearest(std::size_t i, std::size_t count, std::vector<float>& squared) const;
  /// Whether at least `count` others lie within `radius` [m].
  bool hasWithin(std::size_t i, double radius, std::size_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perception
