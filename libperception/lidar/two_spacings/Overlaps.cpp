#include "libperception/lidar/two_spacings/Overlaps.h"

#include <algorithm>
#include <iterator>

namespace perception {
namespace {

/// Trust in obstacle return i.
double trustIn(const LidarDetections& found, std::uint32_t i) {
  return found.trust.empty() ? 1.0 : static_cast<double>(found.trust[i]);
}

double trustIn(const LidarDetections& found, const std::vector<std::uint32_t>& returns) {
  double sum = 0;
  for (const std::uint32_t i : returns) sum += trustIn(found, i);
  return sum;
}

}  // namespace

void settleOverlaps(LidarDetections& found, const PersonParams& params,
                    const ClusterParams& cluster_params) {
  std::vector<std::uint8_t> drop_cluster(found.clusters.size(), 0),
      drop_peak(found.persons.size(), 0);
  std::vector<Eigen::AlignedBox2d> about;
  for (const Cluster& cluster : found.clusters) {
    Eigen::AlignedBox2d box;
    for (const Vector2& corner : cluster.hull) box.extend(corner);
    about.push_back(box);
  }
  for (std::size_t p = 0; p < found.persons.size(); ++p) {
    const PersonPeak& peak = found.persons[p];
    for (std::size_t c = 0; c < found.clusters.size(); ++c) {
      Cluster& cluster = found.clusters[c];
      if (drop_cluster[c] || about[c].exteriorDistance(peak.center) >= params.hull_margin ||
          distanceToHull(cluster.hull, peak.center) >= params.hull_margin)
        continue;
      const double longest = sizeOf(cluster.hull).longest;
      std::vector<std::uint32_t> shared;
      std::set_intersection(peak.points.begin(), peak.points.end(), cluster.points.begin(),
                            cluster.points.end(), std::back_inserter(shared));
      const double share = trustIn(found, shared) / trustIn(found, cluster.points);
      if (longest < cluster_params.min_side && share >= params.replace_share) {
        drop_cluster[c] = 1;
      } else if (cluster.stable || peak.normalized < params.crowd_threshold ||
                 (longest < params.rider_size && share >= params.drop_share)) {
        drop_peak[p] = 1;
      } else if (!shared.empty()) {
        std::vector<std::uint32_t> rest;
        std::set_difference(cluster.points.begin(), cluster.points.end(), shared.begin(),
                            shared.end(), std::back_inserter(rest));
        cluster.points = std::move(rest);
        drop_cluster[c] = trustIn(found, cluster.points) < cluster_params.min_points - 1e-6;
        if (drop_cluster[c]) continue;
        describeCluster(found.x, found.y, found.above, cluster);
        drop_cluster[c] = !hasCarSize(cluster, cluster_params);
      }
    }
  }
  for (std::size_t c = found.clusters.size(); c-- > 0;)
    if (drop_cluster[c])
      found.clusters.erase(found.clusters.begin() + static_cast<std::ptrdiff_t>(c));
  for (std::size_t p = found.persons.size(); p-- > 0;)
    if (drop_peak[p]) found.persons.erase(found.persons.begin() + static_cast<std::ptrdiff_t>(p));
}

}  // namespace perception
