#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"

namespace perception {

/// The double threshold clustering of [radecki2016], method.md 8.2: [sensor.LABEL.clusters].
struct ClusterParams {
  double near_threshold = 0.5;  ///< [m] horizontal [radecki2016]
  double far_threshold = 1.0;   ///< [m] horizontal [radecki2016]
  int min_points = 7;           ///< [radecki2016]
  double min_top = 1.0;         ///< [m] above ground that one return exceeds [radecki2016]
  double max_size = 15;         ///< [m] the length of a bus [radecki2016]
  double min_side = 1.2;        ///< [m] car-sized from this longest side on ... (method.md 8.2)
  double min_area = 0.5;        ///< [m^2] ... or from this area on (method.md 8.2)
  /// Also clusters within far_threshold of others, under their own label (measured on KITTI 0000).
  bool accept_unstable = true;
  double unstable_max_size = 8;    ///< [m] longer: rather hedges and walls than buses (assumed)
  double unstable_min_side = 1.2;  ///< [m] as min_side

  void visit(ParamVisitor& v);
};

/// Returns that belong together. Indices are those of the arrays given to findClusters.
struct Cluster {
  std::vector<std::uint32_t> points;   ///< in the scan's order
  std::vector<Vector2> hull;           ///< [m] convex, counter-clockwise
  Vector2 centroid = Vector2::Zero();  ///< [m] mean of the returns
  float lowest = 0, highest = 0;       ///< [m] above ground
  bool stable = false;                 ///< the identical set at both thresholds
};

/// Car-sized clusters among obstacle points (x, y, height above ground; [m]), in the order of their
/// first points. `weight`: trust in each return, [0, 1]; empty: all 1. min_points counts weights.
std::vector<Cluster> findClusters(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<float>& height, const ClusterParams& params,
                                  const std::vector<float>& weight = {});

/// Fills hull, centroid, lowest and highest of a cluster from its points (at least one).
void describeCluster(const std::vector<float>& x, const std::vector<float>& y,
                     const std::vector<float>& height, Cluster& cluster);

/// Whether the size of a cluster's hull is that of a car-sized (or unstable) detection.
bool hasCarSize(const Cluster& cluster, const ClusterParams& params);

}  // namespace perception
