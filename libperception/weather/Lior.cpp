#include "libperception/weather/Lior.h"

#include "libperception/weather/CloudVerdict.h"
#include "libperception/weather/NeighborTree.h"

namespace perception {

void LiorParams::visit(ParamVisitor& v) {
  v.real("max_intensity", max_intensity, {0, 1}, "", "below which a return may be a phantom");
  v.real("max_range", max_range, {1, 1000}, "m", "up to which it may");
  v.real("radius", radius, {0.001, 5}, "m", "in which neighbors rescue it");
  v.integer("neighbors", neighbors, {1, 100}, "that rescue it");
}

namespace {

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

std::unique_ptr<PointFilter> makeLior(const LiorParams& params) {
  return std::make_unique<Lior>(params);
}

}  // namespace perception
