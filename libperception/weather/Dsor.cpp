#include "libperception/weather/Dsor.h"

#include <algorithm>
#include <cmath>

#include "libperception/weather/CloudVerdict.h"
#include "libperception/weather/NeighborTree.h"

namespace perception {

void DsorParams::visit(ParamVisitor& v) {
  v.integer("neighbors", neighbors, {1, 100}, "whose mean distance counts");
  v.real("spread", spread, {0, 10}, "", "of the scan's deviation above its mean");
  v.real("range_factor", range_factor, {0.001, 10}, "1/m", "growth of the threshold with range");
}

namespace {

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

}  // namespace

std::unique_ptr<PointFilter> makeDsor(const DsorParams& params) {
  return std::make_unique<Dsor>(params);
}

}  // namespace perception
