#pragma once
#include <vector>

#include "libperception/lidar/description/DescribedClusters.h"

namespace perception {

/// Whether a second vehicle would not fit into the cluster.
bool holdsOneVehicle(const Descriptor& descriptor);

/// Joins to likely vehicles what posts, mirrors and dark doors part from them: a cluster beside
/// one becomes part of it if both together are likelier a vehicle than either is alone. `judge`
/// sets the probabilities of a described cluster. `stands`: whether a cluster stands for itself; a
/// joined one no longer does, its returns are the vehicle's.
void joinPieces(const LidarDetections& found, const ClusterDescriber& describer,
                const ClusterVisitor& judge, std::vector<DescribedCluster>& clusters,
                std::vector<char>& stands);

}  // namespace perception
