#include "tests/bench/quality/SnowFilters.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <vector>

namespace perception::bench {
namespace {

/// The scan as nanoflann wants to see it.
struct CloudAdaptor {
  const LidarCloud& cloud;
  std::size_t kdtree_get_point_count() const { return cloud.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return axis == 0 ? cloud.x[i] : axis == 1 ? cloud.y[i] : cloud.z[i];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// A kd-tree over the returns of a scan.
class NeighborTree {
 public:
  explicit NeighborTree(const LidarCloud& cloud) : adaptor_{cloud}, tree_(3, adaptor_, {10}) {
    tree_.buildIndex();
  }

  /// Squared distances [m^2] from a return to its nearest others, ascending; fewer where the scan
  /// has fewer.
  void nearest(std::size_t i, std::size_t count, std::vector<float>& squared) const {
    const LidarCloud& cloud = adaptor_.cloud;
    const float query[3] = {cloud.x[i], cloud.y[i], cloud.z[i]};
    std::vector<std::uint32_t> indices(count + 1);
    squared.resize(count + 1);
    squared.resize(tree_.knnSearch(query, count + 1, indices.data(), squared.data()));
    if (!squared.empty()) squared.erase(squared.begin());  // the return itself
  }

  /// Whether at least `count` others lie within `radius` [m].
  bool hasWithin(std::size_t i, double radius, std::size_t count) const {
    std::vector<float> squared;
    nearest(i, count, squared);
    return squared.size() == count && squared.back() <= static_cast<float>(radius * radius);
  }

 private:
  CloudAdaptor adaptor_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, CloudAdaptor>,
                                      CloudAdaptor, 3, std::uint32_t>
      tree_;
};

/// Range [m] of a return from its sensor.
double rangeOf(const LidarCloud& cloud, std::size_t i) {
  return std::hypot(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                    static_cast<double>(cloud.z[i]));
}

/// Trust 0 for every return of which `isPhantom(i)`, 1 for others.
template <class Verdict>
TrustStats judge(LidarCloud& cloud, const Verdict& isPhantom) {
  TrustStats stats;
  stats.returns = cloud.size();
  cloud.trust.assign(cloud.size(), 1);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isPhantom(i)) continue;
    cloud.trust[i] = 0;
    ++stats.phantoms;
  }
  return stats;
}

class Dror final : public PointFilter {
 public:
  explicit Dror(const DrorParams& params) : params_(params) {}

  TrustStats apply(SensorFrame& frame) override {
    auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr) return {};
    const NeighborTree tree(*cloud);
    return judge(*cloud, [&](std::size_t i) {
      const double range = rangeOf(*cloud, i);
      if (range > params_.max_range) return false;
      if (!cloud->intensity.empty() &&
          static_cast<double>(cloud->intensity[i]) > params_.max_intensity)
        return false;
      const double radius =
          std::max(params_.radius_min, params_.multiplier * range * params_.azimuth);
      return !tree.hasWithin(i, radius, static_cast<std::size_t>(params_.neighbors));
    });
  }

 private:
  DrorParams params_;
};

class Dsor final : public PointFilter {
 public:
  explicit Dsor(const DsorParams& params) : params_(params) {}

  TrustStats apply(SensorFrame& frame) override {
    auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr) return {};
    const std::vector<double> distance = meanDistances(*cloud);
    double sum = 0, squares = 0;
    for (const double d : distance) sum += d, squares += d * d;
    const double count = std::max<double>(1, static_cast<double>(distance.size()));
    const double mean = sum / count;
    const double deviation = std::sqrt(std::max(0.0, squares / count - mean * mean));
    const double scan = mean + params_.spread * deviation;
    return judge(*cloud, [&](std::size_t i) {
      return distance[i] >= scan * params_.range_factor * rangeOf(*cloud, i);
    });
  }

 private:
  std::vector<double> meanDistances(const LidarCloud& cloud) const {
    const NeighborTree tree(cloud);
    std::vector<double> distance(cloud.size(), 0);
    std::vector<float> squared;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      tree.nearest(i, static_cast<std::size_t>(params_.neighbors), squared);
      for (const float s : squared)
        distance[i] += static_cast<double>(std::sqrt(s)) / static_cast<double>(squared.size());
    }
    return distance;
  }

  DsorParams params_;
};

class Lior final : public PointFilter {
 public:
  explicit Lior(const LiorParams& params) : params_(params) {}

  TrustStats apply(SensorFrame& frame) override {
    auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr) return {};
    if (cloud->intensity.empty()) return judge(*cloud, [](std::size_t) { return false; });
    const NeighborTree tree(*cloud);
    return judge(*cloud, [&](std::size_t i) {
      return rangeOf(*cloud, i) <= params_.max_range &&
             static_cast<double>(cloud->intensity[i]) < params_.max_intensity &&
             !tree.hasWithin(i, params_.radius, static_cast<std::size_t>(params_.neighbors));
    });
  }

 private:
  LiorParams params_;
};

}  // namespace

std::unique_ptr<PointFilter> makeDror(const DrorParams& params) {
  return std::make_unique<Dror>(params);
}

std::unique_ptr<PointFilter> makeDsor(const DsorParams& params) {
  return std::make_unique<Dsor>(params);
}

std::unique_ptr<PointFilter> makeLior(const LiorParams& params) {
  return std::make_unique<Lior>(params);
}

}  // namespace perception::bench
