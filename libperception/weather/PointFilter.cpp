#include "libperception/weather/PointFilter.h"

#include "libperception/weather/PointTrust.h"

namespace perception {
namespace {

/// A filter followed by the test for mirror images, which uses its trust.
class WithMultipath final : public PointFilter {
 public:
  WithMultipath(std::unique_ptr<PointFilter> filter, const MultipathParams& params)
      : filter_(std::move(filter)), params_(params) {}

  TrustStats apply(SensorFrame& frame) override {
    TrustStats stats = filter_->apply(frame);
    auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr || !params_.enabled) return stats;
    for (const std::uint32_t i : findMirrorImages(frame, params_)) {
      stats.phantoms += cloud->trust[i] >= 0.5F;
      cloud->trust[i] = 0;
      ++stats.mirrored;
    }
    return stats;
  }

  AirCensus census(const SensorFrame& frame) const override { return filter_->census(frame); }

 private:
  std::unique_ptr<PointFilter> filter_;
  MultipathParams params_;
};

}  // namespace

void WeatherParams::visit(ParamVisitor& v) {
  bool filter_on = filter == "trust";
  v.choiceOf("filter", filter_on, {"off", "trust"},
             "trust of lidar returns; off: all 1; trust: the model of [weather.trust]");
  filter = filter_on ? "trust" : "off";
}

WeatherParams WeatherParams::read(Config& config) {
  WeatherParams params = config.read<WeatherParams>("weather");
  params.trust = config.read<TrustParams>("weather.trust");
  params.multipath = config.read<MultipathParams>("weather.multipath");
  return params;
}

std::unique_ptr<PointFilter> makePointFilter(const WeatherParams& params) {
  if (params.filter == "off") return nullptr;
  return std::make_unique<WithMultipath>(makePointTrust(params.trust), params.multipath);
}

}  // namespace perception
