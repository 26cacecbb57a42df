#pragma once
#include "libperception/lidar/LidarFrontEnd.h"

namespace perception {

/// One object, one detection, and no return in two: where a peak lies in a cluster's hull, one of
/// the two goes or they are parted. A peak that explains most of a short cluster is a person with
/// legs apart; one that is the middle of something rider-sized belongs to it; else the cluster is
/// something larger and the peak its corner (method.md 8.3). A clear peak beside something unstable
/// is a person standing close to it: its returns leave the cluster.
void settleOverlaps(LidarDetections& found, const PersonParams& params,
                    const ClusterParams& cluster_params);

}  // namespace perception
