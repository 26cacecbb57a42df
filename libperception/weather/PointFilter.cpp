#include "libperception/weather/PointFilter.h"

#include <algorithm>

#include "libperception/weather/trust/PointTrust.h"

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
    mirrored_.clear();
    if (cloud == nullptr || !params_.enabled) return stats;
    mirrored_ = findMirrorImages(frame, params_);
    for (const std::uint32_t i : mirrored_) {
      stats.phantoms += cloud->trust[i] >= 0.5F;
      if (const auto doubt = filter_->doubtAbout(i)) stats.doubts.remove(*doubt);
      stats.doubts.add({DoubtCause::kMirror, 0});
      stats.weight_lost += static_cast<double>(cloud->trust[i]);
      cloud->trust[i] = 0;
      ++stats.mirrored;
    }
    return stats;
  }

  AirCensus census(const SensorFrame& frame) const override { return filter_->census(frame); }

  std::optional<Doubt> doubtAbout(std::uint32_t i) const override {
    if (std::binary_search(mirrored_.begin(), mirrored_.end(), i))
      return Doubt{DoubtCause::kMirror, 0};
    return filter_->doubtAbout(i);
  }

 private:
  std::unique_ptr<PointFilter> filter_;
  MultipathParams params_;
  std::vector<std::uint32_t> mirrored_;  // of the last scan, ascending
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
