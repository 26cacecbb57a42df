#include "libperception/lidar/classification/CloudedSurfaces.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "libperception/lidar/segments/Segments.h"

namespace perception {
namespace {

constexpr double kLeastFirm = 0.5;  // of the cluster (assumed)

bool isLow(const LidarDetections& found, const std::vector<std::uint32_t>& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](std::uint32_t i) { return found.above[i] < kLeastTop; });
}

}  // namespace

std::vector<DescribedCluster> surfacesIn(const std::vector<std::uint32_t>& cluster,
                                         const LidarDetections& found,
                                         const ClusterDescriber& describer,
                                         const ClusterVisitor& judge) {
  if (found.trust.empty()) return {};
  std::vector<std::uint32_t> firm;
  std::vector<float> x, y, above, trust;
  for (const std::uint32_t i : cluster) {
    if (found.trust[i] < kHardlyDoubted) continue;
    firm.push_back(i);
    x.push_back(found.x[i]), y.push_back(found.y[i]), above.push_back(found.above[i]);
    trust.push_back(found.trust[i]);
  }
  if (firm.size() == cluster.size() ||
      static_cast<double>(firm.size()) < kLeastFirm * static_cast<double>(cluster.size()))
    return {};
  const SegmentFinder finder(x, y, above, kFewestReturns, kLongestCluster, trust, std::nullopt);
  const auto no_parts = [](const Segment&) { return false; };
  std::vector<DescribedCluster> surfaces;
  for (std::size_t tree = 0; tree < finder.trees(); ++tree) {
    for (const Segment& segment : finder.find(tree, no_parts)) {
      DescribedCluster surface;
      for (const std::uint32_t k : segment.points) surface.segment.points.push_back(firm[k]);
      if (isLow(found, surface.segment.points)) continue;
      surface.descriptor = describer.describe(surface.segment.points);
      judge(surface);
      surfaces.push_back(std::move(surface));
    }
  }
  return surfaces;
}

double meanTrust(const std::vector<std::uint32_t>& cluster, const LidarDetections& found) {
  if (found.trust.empty()) return 1;
  double sum = 0;
  for (const std::uint32_t i : cluster) sum += static_cast<double>(found.trust[i]);
  return sum / static_cast<double>(cluster.size());
}

}  // namespace perception
