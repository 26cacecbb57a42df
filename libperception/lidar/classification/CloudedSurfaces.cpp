#include "libperception/lidar/classification/CloudedSurfaces.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "libperception/lidar/segments/LooseReturns.h"
#include "libperception/lidar/segments/Segments.h"

namespace perception {
namespace {

constexpr double kLeastFirm = 0.5;  // of the cluster (assumed)
/// Share of the directions about a return of a wall that end at its range, and returns of the least
/// one that is looked for (assumed).
constexpr float kSolid = 0.75f;
constexpr std::size_t kLeastWall = 10;

bool isLow(const LidarDetections& found, const std::vector<std::uint32_t>& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](std::uint32_t i) { return found.above[i] < kLeastTop; });
}

/// The groups of some of the obstacles, judged.
std::vector<DescribedCluster> groupsOf(const std::vector<std::uint32_t>& firm,
                                       const LidarDetections& found,
                                       const ClusterDescriber& describer,
                                       const ClusterVisitor& judge) {
  std::vector<float> x, y, above, trust;
  for (const std::uint32_t i : firm) {
    x.push_back(found.x[i]), y.push_back(found.y[i]), above.push_back(found.above[i]);
    trust.push_back(found.trust.empty() ? 1 : found.trust[i]);
  }
  const SegmentFinder finder(x, y, above, kFewestReturns, kLongestCluster, trust, std::nullopt);
  std::vector<DescribedCluster> groups;
  for (std::size_t tree = 0; tree < finder.trees(); ++tree) {
    for (const Segment& segment : finder.find(tree, [](const Segment&) { return false; })) {
      DescribedCluster group;
      for (const std::uint32_t k : segment.points) group.segment.points.push_back(firm[k]);
      if (isLow(found, group.segment.points)) continue;
      group.descriptor = describer.describe(group.segment.points);
      judge(group);
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

}  // namespace

std::vector<DescribedCluster> surfacesIn(const std::vector<std::uint32_t>& cluster,
                                         const LidarDetections& found,
                                         const ClusterDescriber& describer,
                                         const ClusterVisitor& judge) {
  if (found.trust.empty()) return {};
  std::vector<std::uint32_t> firm;
  for (const std::uint32_t i : cluster)
    if (found.trust[i] >= kHardlyDoubted) firm.push_back(i);
  if (firm.size() == cluster.size() ||
      static_cast<double>(firm.size()) < kLeastFirm * static_cast<double>(cluster.size()))
    return {};
  return groupsOf(firm, found, describer, judge);
}

std::vector<DescribedCluster> wallsIn(const std::vector<std::uint32_t>& cluster,
                                      const LidarDetections& found, const DirectionCells& cells,
                                      const ClusterDescriber& describer,
                                      const ClusterVisitor& judge) {
  std::vector<std::uint32_t> points, firm;
  for (const std::uint32_t i : cluster) points.push_back(found.obstacles[i]);
  const std::vector<float> shares = solidShares(cells, points);
  for (std::size_t k = 0; k < cluster.size(); ++k)
    if (shares[k] >= kSolid) firm.push_back(cluster[k]);
  if (firm.size() == cluster.size() || firm.size() < kLeastWall) return {};
  return groupsOf(firm, found, describer, judge);
}

double meanTrust(const std::vector<std::uint32_t>& cluster, const LidarDetections& found) {
  if (found.trust.empty()) return 1;
  double sum = 0;
  for (const std::uint32_t i : cluster) sum += static_cast<double>(found.trust[i]);
  return sum / static_cast<double>(cluster.size());
}

}  // namespace perception
