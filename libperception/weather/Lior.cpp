#include "libperception/weather/Lior.h"

#include <cmath>

#include "libperception/weather/NeighbourTree.h"
#include "libperception/weather/PointFilter.h"

namespace perception {

void LiorParams::visit(ParamVisitor& v) {
  v.real("max_intensity", max_intensity, {0, 1}, "", "below which a return may be a phantom");
  v.real("max_range", max_range, {1, 1000}, "m", "up to which it may");
  v.real("radius", radius, {0.001, 5}, "m", "in which neighbours rescue it");
  v.integer("neighbours", neighbours, {1, 100}, "that rescue it");
}

namespace {

class Lior final : public PointFilter {
 public:
  explicit Lior(const LiorParams& params) : params_(params) {}

  TrustStats apply(SensorFrame& frame) override {
    TrustStats stats;
    auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr) return stats;
    stats.returns = cloud->size();
    cloud->trust.assign(cloud->size(), 1);
    if (cloud->intensity.empty()) return stats;
    const NeighbourTree tree(*cloud);
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      const double range =
          std::hypot(static_cast<double>(cloud->x[i]), static_cast<double>(cloud->y[i]),
                     static_cast<double>(cloud->z[i]));
      if (range > params_.max_range ||
          static_cast<double>(cloud->intensity[i]) >= params_.max_intensity)
        continue;
      if (tree.hasWithin(i, params_.radius, static_cast<std::size_t>(params_.neighbours))) continue;
      cloud->trust[i] = 0;
      ++stats.phantoms;
    }
    return stats;
  }

 private:
  LiorParams params_;
};

}  // namespace

std::unique_ptr<PointFilter> makeLior(const LiorParams& params) {
  return std::make_unique<Lior>(params);
}

}  // namespace perception
