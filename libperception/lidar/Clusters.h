#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"

namespace perception {

/// The double threshold clustering of the paper ("Lidar Segmentation"): [sensor.LABEL.clusters].
struct ClusterParams {
  double near_threshold = 0.5;  ///< [m] horizontal (paper)
  double far_threshold = 1.0;   ///< [m] horizontal (paper)
  int min_points = 7;           ///< (paper)
  double min_top = 1.0;         ///< [m] above ground that one return at least exceeds (paper)
  double max_size = 15;         ///< [m] the length of a bus (paper)
  double min_side =
      1.2;  ///< [m] a cluster is car-sized from this longest side on ... (method.md 8.2)
  double min_area = 0.5;  ///< [m^2] ... or from this area on
  bool accept_unstable =
      true;  ///< also clusters that stand within far_threshold of others, under their own label
  double unstable_max_size =
      8;  ///< [m] of those: longer ones are hedges and walls more often than buses
  double unstable_min_side = 1.2;  ///< [m]

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
