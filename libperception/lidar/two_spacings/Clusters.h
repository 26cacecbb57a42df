#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"

namespace perception {

/// Parameters of [radecki2016]'s clustering with two thresholds (method.md 8.2):
/// [sensor.LABEL.clusters].
struct ClusterParams {
  double near_threshold = 0.5;  ///< [m] horizontal [radecki2016]
  double far_threshold = 1.0;   ///< [m] horizontal [radecki2016]
  int min_points = 7;           ///< [radecki2016]
  double min_top = 1.0;         ///< [m] above ground, exceeded by at least one return [radecki2016]
  double max_size = 15;         ///< [m] the length of a bus [radecki2016]
  double min_side = 1.2;  ///< [m] least longest side of a car-sized cluster ... (method.md 8.2)
  double min_area = 0.5;  ///< [m^2] ... or its least area (method.md 8.2)
  /// Whether to use clusters within far_threshold of others, labeled "unstable" (measured on KITTI
  /// 0000).
  bool accept_unstable = true;
  double unstable_max_size = 8;    ///< [m] longer ones are mostly hedges and walls (assumed)
  double unstable_min_side = 1.2;  ///< [m] as min_side

  void visit(ParamVisitor& v);
};

/// A group of returns, as indices into the arrays given to findClusters().
struct Cluster {
  std::vector<std::uint32_t> points;   ///< in the scan's order
  std::vector<Vector2> hull;           ///< [m] convex, counter-clockwise
  Vector2 centroid = Vector2::Zero();  ///< [m] mean of the returns
  float lowest = 0, highest = 0;       ///< [m] above ground
  bool stable = false;                 ///< the same set of returns at both thresholds
};

/// Car-sized clusters among obstacle points (x, y, height above ground; [m]), in the order of their
/// first points. `weight`: trust in each return, [0, 1]; empty: all 1. min_points applies to the
/// sum of weights.
std::vector<Cluster> findClusters(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<float>& height, const ClusterParams& params,
                                  const std::vector<float>& weight = {});

/// Computes hull, centroid, lowest and highest of a cluster from its points (at least one).
void describeCluster(const std::vector<float>& x, const std::vector<float>& y,
                     const std::vector<float>& height, Cluster& cluster);

/// Whether the size of a cluster's hull is that of a car-sized (or unstable) detection.
bool hasCarSize(const Cluster& cluster, const ClusterParams& params);

}  // namespace perception
