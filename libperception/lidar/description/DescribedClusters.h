#pragma once
#include <array>
#include <functional>
#include <vector>

#include "libperception/lidar/description/ClusterDescriptor.h"
#include "libperception/lidar/description/ClusterKind.h"
#include "libperception/lidar/segments/Segments.h"

namespace perception {

/// Clusters have so many returns and reach so high [m] at least, and are so long [m] at most.
inline constexpr double kFewestReturns = 8, kLongestCluster = 20;
inline constexpr float kLeastTop = 0.5f;

struct DescribedCluster {
  Segment segment;  ///< `whole`: index into the same list
  Descriptor descriptor{};
  bool described = true;                              ///< false: it is beyond reach
  std::array<double, kClusterKinds> probabilities{};  ///< left to the visitor
};

/// Called with every cluster before its parts, by several threads; false: its parts are not wanted.
using ClusterVisitor = std::function<bool(DescribedCluster&)>;

/// The segments of a scan that are large enough to be told by their shape, and their descriptors:
/// 8 returns or more (assumed: the fewest of a person at 40 m from 64 beams), up to the length of
/// an articulated bus (20 m), and so high that they may be a road user (0.5 m; assumed). `cells`:
/// of all points of `found`. Wholes that are farther from the sensor than `reach` [m] are not
/// described.
std::vector<DescribedCluster> describedClusters(const LidarDetections& found,
                                                const LidarCloud& cloud,
                                                const DirectionCells& cells,
                                                const ClusterVisitor& visit = {},
                                                double reach = 1e9);

/// The same by a describer of that scan.
std::vector<DescribedCluster> describedClusters(const LidarDetections& found,
                                                const ClusterDescriber& describer,
                                                const ClusterVisitor& visit, double reach);

}  // namespace perception
