#include "libperception/lidar/description/DescribedClusters.h"

#include <algorithm>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/lidar/description/DescriptorParts.h"

namespace perception {
namespace {

/// Whether the box about returns is farther from the sensor than `reach` [m], and so their hull.
bool isBeyond(const LidarDetections& found, const std::vector<std::uint32_t>& returns,
              double reach) {
  const auto x = static_cast<float>(found.points.sensor.x()),
             y = static_cast<float>(found.points.sensor.y());
  const auto most = static_cast<float>(reach * reach);
  Interval across, along;
  for (const std::uint32_t i : returns) {
    const float dx = found.x[i] - x, dy = found.y[i] - y;
    if (dx * dx + dy * dy <= most) return false;
    along.add(dx), across.add(dy);
  }
  const float ahead = std::max({along.low, -along.high, 0.0f}),
              aside = std::max({across.low, -across.high, 0.0f});
  return ahead * ahead + aside * aside > most;
}

/// What the clusters of a scan are described by.
struct Describing {
  const LidarDetections& found;
  const ClusterDescriber& describer;
  const ClusterVisitor& visit;
  double reach;  ///< [m]
};

/// Those of a tree of segments that are high enough; `whole` is an index into them.
std::vector<DescribedCluster> clustersOf(const Describing& by, const SegmentFinder& finder,
                                         std::size_t tree) {
  std::vector<DescribedCluster> clusters;
  std::vector<int> number;  // of every segment; -1: too low
  finder.find(tree, [&](const Segment& segment) {
    const bool low = std::all_of(segment.points.begin(), segment.points.end(),
                                 [&](std::uint32_t i) { return by.found.above[i] < kLeastTop; });
    number.push_back(low ? -1 : static_cast<int>(clusters.size()));
    if (low) return false;
    const bool described = segment.whole >= 0 || !isBeyond(by.found, segment.points, by.reach);
    clusters.push_back(
        {segment, described ? by.describer.describe(segment.points) : Descriptor{}, described});
    int& whole = clusters.back().segment.whole;
    if (whole >= 0) whole = number[static_cast<std::size_t>(whole)];
    return !by.visit || by.visit(clusters.back());
  });
  return clusters;
}

}  // namespace

std::vector<DescribedCluster> describedClusters(const LidarDetections& found,
                                                const LidarCloud& cloud,
                                                const DirectionCells& cells,
                                                const ClusterVisitor& visit, double reach) {
  return describedClusters(found, ClusterDescriber(found, cloud, cells), visit, reach);
}

std::vector<DescribedCluster> describedClusters(const LidarDetections& found,
                                                const ClusterDescriber& describer,
                                                const ClusterVisitor& visit, double reach) {
  Vector3 sensor = found.points.sensor;
  sensor.z() -= found.surface.heightAt(sensor.x(), sensor.y());
  const SegmentFinder finder(found.x, found.y, found.above, kFewestReturns, kLongestCluster,
                             found.trust, sensor);
  std::vector<std::vector<DescribedCluster>> of_tree(finder.trees());
  parallelFor(of_tree.size(), [&](std::size_t tree) {
    of_tree[tree] = clustersOf({found, describer, visit, reach}, finder, tree);
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
