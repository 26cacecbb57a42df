#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/description/DescribedClusters.h"

namespace perception {

/// The surfaces that fog, flakes or drops have joined with themselves and with each other to a
/// cluster of obstacles, judged: the groups of those of its returns that are hardly doubted. None
/// where nothing is doubted, or more than half: that is a cloud. See method.md 8.10.
std::vector<DescribedCluster> surfacesIn(const std::vector<std::uint32_t>& cluster,
                                         const LidarDetections& found,
                                         const ClusterDescriber& describer,
                                         const ClusterVisitor& judge);

/// The surfaces in a cluster of spray or flakes that let no beam pass, judged: the groups of those
/// of its returns about which nearly all directions end. Beams pass a cloud, and none passes the
/// rear of a car. None where all do, or fewer than ten. See method.md 8.10.
std::vector<DescribedCluster> wallsIn(const std::vector<std::uint32_t>& cluster,
                                      const LidarDetections& found, const DirectionCells& cells,
                                      const ClusterDescriber& describer,
                                      const ClusterVisitor& judge);

/// Mean trust in the returns of a cluster of obstacles.
double meanTrust(const std::vector<std::uint32_t>& cluster, const LidarDetections& found);

}  // namespace perception
