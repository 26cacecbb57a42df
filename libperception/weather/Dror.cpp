#include "libperception/weather/Dror.h"

#include <algorithm>

#include "libperception/weather/CloudVerdict.h"
#include "libperception/weather/NeighborTree.h"

namespace perception {

void DrorParams::visit(ParamVisitor& v) {
  v.angle("azimuth_deg", azimuth, {0.01, 5}, "between beams");
  v.real("multiplier", multiplier, {0.1, 100}, "", "of the distance between beams");
  v.real("radius_min", radius_min, {0.001, 5}, "m", "least radius");
  v.integer("neighbors", neighbors, {1, 100}, "that keep a return");
  v.real("max_intensity", max_intensity, {0, 1}, "", "of a phantom");
  v.real("max_range", max_range, {1, 1000}, "m", "of a phantom");
}

namespace {

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

}  // namespace

std::unique_ptr<PointFilter> makeDror(const DrorParams& params) {
  return std::make_unique<Dror>(params);
}

}  // namespace perception
