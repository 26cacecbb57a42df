#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// A cluster that is judged a phantom (method.md 8.10), so it gives no measurement.
struct PhantomCluster {
  std::size_t returns = 0;
  double probability = 0;  ///< [0, 1] P(phantom)
  /// Indices in the frame's cloud of its returns with a trust below one half.
  std::vector<std::uint32_t> doubted;
  Vector2 center = Vector2::Zero();  ///< [m] mean of its returns, ego frame
};

/// How a front end judged the clusters of a lidar scan by their shape.
struct ClusterVerdicts {
  std::size_t clusters = 0;  ///< judged: wholes, or the parts given in their place
  /// Given as measurements although likelier a phantom than not.
  std::size_t suspicious = 0;
  std::vector<PhantomCluster> phantoms;
};

}  // namespace perception
