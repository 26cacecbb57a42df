#include "libperception/lidar/description/DescribedClusters.h"

#include <algorithm>
#include <utility>

#include "libperception/core/system/Parallel.h"

namespace perception {
namespace {

/// Those of a tree of segments that are high enough; `whole` is an index into them.
std::vector<DescribedCluster> clustersOf(const SegmentFinder& finder, std::size_t tree,
                                         const LidarDetections& found,
                                         const ClusterDescriber& describer,
                                         const ClusterVisitor& visit) {
  constexpr float kLeastTop = 0.5f;  // [m]
  std::vector<DescribedCluster> clusters;
  std::vector<int> number;  // of every segment; -1: too low
  finder.find(tree, [&](const Segment& segment) {
    const bool low = std::all_of(segment.points.begin(), segment.points.end(),
                                 [&](std::uint32_t i) { return found.above[i] < kLeastTop; });
    number.push_back(low ? -1 : static_cast<int>(clusters.size()));
    if (low) return false;
    clusters.push_back({segment, describer.describe(segment.points)});
    int& whole = clusters.back().segment.whole;
    if (whole >= 0) whole = number[static_cast<std::size_t>(whole)];
    return !visit || visit(clusters.back());
  });
  return clusters;
}

}  // namespace

std::vector<DescribedCluster> describedClusters(const LidarDetections& found,
                                                const LidarCloud& cloud,
                                                const DirectionCells& cells,
                                                const ClusterVisitor& visit) {
  constexpr double kLeastReturns = 8, kLongest = 20;  // [m]
  Vector3 sensor = found.points.sensor;
  sensor.z() -= found.surface.heightAt(sensor.x(), sensor.y());
  const ClusterDescriber describer(found, cloud, cells);
  const SegmentFinder finder(found.x, found.y, found.above, kLeastReturns, kLongest, found.trust,
                             sensor, {});
  std::vector<std::vector<DescribedCluster>> of_tree(finder.trees());
  parallelFor(of_tree.size(), [&](std::size_t tree) {
    of_tree[tree] = clustersOf(finder, tree, found, describer, visit);
  });
  std::vector<DescribedCluster> clusters;
  for (std::vector<DescribedCluster>& tree : of_tree) {
    const auto first = static_cast<int>(clusters.size());
    for (DescribedCluster& cluster : tree) {
      if (cluster.segment.whole >= 0) cluster.segment.whole += first;
      clusters.push_back(std::move(cluster));
    }
  }
  return clusters;
}

}  // namespace perception
