#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Where surfaces that are doubted were seen in the scan before: what is there again is one, for
/// flakes and drops are elsewhere by then (method.md 8.4).
class PersistentPlaces {
 public:
  /// The next scan's doubted surfaces [m, world]: whether each is at a place that had some before,
  /// too; two in a cube of 0.4 m then and now.
  std::vector<char> add(const std::vector<Vector3>& surfaces);
  void clear() { before_.clear(); }

 private:
  std::vector<std::uint64_t> before_;  ///< cubes, ascending
};

}  // namespace perception
