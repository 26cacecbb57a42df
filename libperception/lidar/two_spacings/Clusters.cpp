#include "libperception/lidar/two_spacings/Clusters.h"

#include <algorithm>
#include <cmath>

#include "libperception/lidar/linkage/Linkage.h"
#include "libperception/lidar/outline/BoxFit.h"

namespace perception {

void ClusterParams::visit(ParamVisitor& v) {
  v.integer("min_points", min_points, {1, 10000}, "returns that a cluster needs");
  v.real("min_top", min_top, {0, 5}, "m", "height that one return must exceed");
  v.boolean("accept_unstable", accept_unstable, "use clusters close to others, labeled unstable");
  v.expert();
  v.real("near_threshold", near_threshold, {0.05, 5}, "m", "single linkage");
  v.real("far_threshold", far_threshold, {0.1, 10}, "m",
         "second single linkage; a cluster equal at both is stable");
  v.require(near_threshold < far_threshold, "near_threshold must be below far_threshold");
}

namespace {

constexpr std::uint32_t kNoCluster = ~0u;

/// Properties by which a group is rejected before its hull is computed.
struct Candidate {
  std::uint32_t points = 0;
  double weight = 0;                                   ///< sum of the trust in its returns
  float highest = 0;                                   ///< [m] above ground
  float x0 = kFar, y0 = kFar, x1 = -kFar, y1 = -kFar;  ///< [m] about its returns
  static constexpr float kFar = 1e30f;
};

/// False when no enclosing rectangle of the hull can be of a cluster's size: its diagonal lies
/// between the longer side and the diagonal of the axis-aligned bounds, and its longest side is at
/// least diagonal / sqrt(2).
bool mayHaveCarSize(const Candidate& c, bool stable, const ClusterParams& params) {
  const auto width = static_cast<double>(c.x1 - c.x0), depth = static_cast<double>(c.y1 - c.y0);
  const double least = std::max(width, depth) * (std::sqrt(0.5) - 1e-6);
  const double most = std::hypot(width, depth) * (1 + 1e-6);
  if (least >= (stable ? params.max_size : params.unstable_max_size)) return false;
  if (!stable) return most >= params.unstable_min_side;
  return most >= params.min_side || width * depth * (1 + 1e-6) >= params.min_area;
}

std::vector<Candidate> candidatesOf(const std::vector<float>& x, const std::vector<float>& y,
                                    const std::vector<float>& height,
                                    const std::vector<float>& weight, const Partition& groups) {
  std::vector<Candidate> candidates(groups.count);
  for (std::size_t i = 0; i < x.size(); ++i) {
    Candidate& c = candidates[groups.group[i]];
    ++c.points;
    c.weight += weight.empty() ? 1.0 : static_cast<double>(weight[i]);
    c.highest = std::max(c.highest, height[i]);
    c.x0 = std::min(c.x0, x[i]), c.x1 = std::max(c.x1, x[i]);
    c.y0 = std::min(c.y0, y[i]), c.y1 = std::max(c.y1, y[i]);
  }
  return candidates;
}

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
                                  const std::vector<float>& height, const ClusterParams& params,
                                  const std::vector<float>& weight) {
  const DoubleLinkage linkage = linkTwice(x, y, params.near_threshold, params.far_threshold);
  const std::vector<std::uint32_t>& group = linkage.near.group;
  const std::vector<Candidate> candidates = candidatesOf(x, y, height, weight, linkage.near);

  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> number(linkage.near.count, kNoCluster);
  for (std::uint32_t g = 0; g < linkage.near.count; ++g) {
    const Candidate& candidate = candidates[g];
    const bool stable = linkage.parts[linkage.far_of_near[g]] == 1;
    if (candidate.weight < params.min_points - 1e-6 ||
        candidate.highest <= static_cast<float>(params.min_top) ||
        (!stable && !params.accept_unstable) || !mayHaveCarSize(candidate, stable, params))
      continue;
    number[g] = static_cast<std::uint32_t>(clusters.size());
    clusters.emplace_back();
    clusters.back().stable = stable;
    clusters.back().points.reserve(candidate.points);
  }
  for (std::size_t i = 0; i < group.size(); ++i)
    if (const std::uint32_t n = number[group[i]]; n != kNoCluster)
      clusters[n].points.push_back(static_cast<std::uint32_t>(i));

  for (Cluster& cluster : clusters) describeCluster(x, y, height, cluster);
  clusters.erase(
      std::remove_if(clusters.begin(), clusters.end(),
                     [&](const Cluster& cluster) { return !hasCarSize(cluster, params); }),
      clusters.end());
  return clusters;
}

}  // namespace perception
