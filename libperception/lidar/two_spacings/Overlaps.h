#pragma once
#include "libperception/lidar/LidarFrontEnd.h"

namespace perception {

/// Resolves overlaps of person peaks and clusters, so that each object gives one detection and each
/// return is part of at most one (method.md 8.3). A peak with most of the returns of a short
/// cluster replaces it (a person with legs apart). Peaks in stable clusters, weak peaks and those
/// with a large share of a rider-sized cluster are parts of the cluster and dropped. A strong peak
/// in an unstable cluster is a person close to something else: its returns are removed from the
/// cluster.
void settleOverlaps(LidarDetections& found, const PersonParams& params,
                    const ClusterParams& cluster_params);

}  // namespace perception
