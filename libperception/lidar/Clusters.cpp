#include "libperception/lidar/Clusters.h"

#include <algorithm>

#include "libperception/lidar/BoxFit.h"
#include "libperception/lidar/Linkage.h"

namespace perception {

void ClusterParams::visit(ParamVisitor& v) {
  v.real("near_threshold", near_threshold, {0.05, 5}, "m", "single linkage (paper)");
  v.real("far_threshold", far_threshold, {0.1, 10}, "m",
         "second single linkage; the same set is stable (paper)");
  v.integer("min_points", min_points, {1, 10000}, "returns that a cluster needs (paper)");
  v.real("min_top", min_top, {0, 5}, "m", "height that one return must exceed (paper)");
  v.real("max_size", max_size, {1, 100}, "m", "largest dimension (paper)");
  v.real("min_side", min_side, {0, 10}, "m", "longest side from which a cluster is car-sized");
  v.real("min_area", min_area, {0, 50}, "m^2", "area from which a cluster is car-sized");
  v.boolean("accept_unstable", accept_unstable, "clusters close to others, too, labelled unstable");
  v.real("unstable_max_size", unstable_max_size, {1, 100}, "m", "largest dimension of those");
  v.real("unstable_min_side", unstable_min_side, {0, 10}, "m", "smallest longest side of those");
  v.require(near_threshold < far_threshold, "near_threshold must be below far_threshold");
}

namespace {

struct Candidate {
  std::uint32_t points = 0;
  float highest = 0;
};

}  // namespace

bool hasCarSize(const Cluster& cluster, const ClusterParams& params) {
  const HullSize size = sizeOf(cluster.hull);
  if (cluster.stable)
    return size.longest < params.max_size &&
           (size.longest >= params.min_side || size.area >= params.min_area);
  return size.longest < params.unstable_max_size && size.longest >= params.unstable_min_side;
}

void describeCluster(const std::vector<float>& x, const std::vector<float>& y,
                     const std::vector<float>& height, Cluster& cluster) {
  std::vector<Vector2> places;
  places.reserve(cluster.points.size());
  cluster.centroid.setZero();
  cluster.lowest = cluster.highest = height[cluster.points.front()];
  for (const std::uint32_t i : cluster.points) {
    places.emplace_back(static_cast<double>(x[i]), static_cast<double>(y[i]));
    cluster.centroid += places.back();
    cluster.lowest = std::min(cluster.lowest, height[i]),
    cluster.highest = std::max(cluster.highest, height[i]);
  }
  cluster.centroid /= static_cast<double>(cluster.points.size());
  cluster.hull = convexHull(std::move(places));
}

std::vector<Cluster> findClusters(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<float>& height, const ClusterParams& params) {
  const DoubleLinkage linkage = linkTwice(x, y, params.near_threshold, params.far_threshold);
  const std::vector<std::uint32_t>& group = linkage.near.group;
  std::vector<Candidate> candidates(linkage.near.count);
  for (std::size_t i = 0; i < group.size(); ++i) {
    Candidate& candidate = candidates[group[i]];
    ++candidate.points;
    candidate.highest = std::max(candidate.highest, height[i]);
  }

  std::vector<Cluster> clusters;
  std::vector<int> number(linkage.near.count, -1);
  for (std::uint32_t g = 0; g < linkage.near.count; ++g) {
    const bool stable = linkage.parts[linkage.far_of_near[g]] == 1;
    if (candidates[g].points < static_cast<std::uint32_t>(params.min_points) ||
        candidates[g].highest <= static_cast<float>(params.min_top) ||
        (!stable && !params.accept_unstable))
      continue;
    number[g] = static_cast<int>(clusters.size());
    clusters.emplace_back();
    clusters.back().stable = stable;
    clusters.back().points.reserve(candidates[g].points);
  }
  for (std::size_t i = 0; i < group.size(); ++i)
    if (number[group[i]] >= 0)
      clusters[static_cast<std::size_t>(number[group[i]])].points.push_back(
          static_cast<std::uint32_t>(i));

  for (Cluster& cluster : clusters) describeCluster(x, y, height, cluster);
  clusters.erase(
      std::remove_if(clusters.begin(), clusters.end(),
                     [&](const Cluster& cluster) { return !hasCarSize(cluster, params); }),
      clusters.end());
  return clusters;
}

}  // namespace perception
