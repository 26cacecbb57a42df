#include "libperception/weather/PointFilter.h"

#include "libperception/weather/PointTrust.h"

namespace perception {
namespace {

/// A row per filter.
struct FilterRow {
  const char* name;
  std::unique_ptr<PointFilter> (*make)(const WeatherParams&);
};

constexpr FilterRow kFilters[] = {
    {"trust", [](const WeatherParams& p) { return makePointTrust(p.trust); }},
    {"dror", [](const WeatherParams& p) { return makeDror(p.dror); }},
    {"dsor", [](const WeatherParams& p) { return makeDsor(p.dsor); }},
    {"lior", [](const WeatherParams& p) { return makeLior(p.lior); }},
};

/// A filter, and then the test for mirror images, which needs to know what the phantoms are.
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

 private:
  std::unique_ptr<PointFilter> filter_;
  MultipathParams params_;
};

}  // namespace

const std::vector<std::string>& pointFilterNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {"off"};
    for (const FilterRow& row : kFilters) all.emplace_back(row.name);
    return all;
  }();
  return names;
}

void WeatherParams::visit(ParamVisitor& v) {
  const auto& names = pointFilterNames();
  int index = 0;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == filter) index = static_cast<int>(i);
  v.choice("filter", index, names,
           "how far each lidar return is trusted; trust: the model of [weather.trust]");
  filter = names[static_cast<std::size_t>(index)];
}

WeatherParams WeatherParams::read(Config& config) {
  WeatherParams params = config.read<WeatherParams>("weather");
  params.trust = config.read<TrustParams>("weather.trust");
  params.dror = config.read<DrorParams>("weather.dror");
  params.dsor = config.read<DsorParams>("weather.dsor");
  params.lior = config.read<LiorParams>("weather.lior");
  params.multipath = config.read<MultipathParams>("weather.multipath");
  return params;
}

std::unique_ptr<PointFilter> makePointFilter(const WeatherParams& params) {
  for (const FilterRow& row : kFilters)
    if (params.filter == row.name)
      return std::make_unique<WithMultipath>(row.make(params), params.multipath);
  return nullptr;
}

}  // namespace perception
