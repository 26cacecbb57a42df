#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Where doubted surfaces were seen in the scan before. What is at the same place again is a real
/// surface, since flakes and drops have moved on by then (method.md 8.4).
class PersistentPlaces {
 public:
  /// Takes the next scan's doubted surfaces [m, world] and says of each whether its place had such
  /// surfaces in the scan before: at least two in a cube of 0.4 m, then and now.
  std::vector<char> add(const std::vector<Vector3>& surfaces);
  void clear() { before_.clear(); }

 private:
  std::vector<std::uint64_t> before_;  ///< cubes, ascending
};

}  // namespace perception
