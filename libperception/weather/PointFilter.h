#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/weather/Doubt.h"
#include "libperception/weather/Multipath.h"
#include "libperception/weather/state/AirCensus.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

/// Statistics of one filtered scan.
struct TrustStats {
  std::size_t returns = 0;
  std::size_t phantoms = 0;  ///< with a trust below one half
  std::size_t mirrored = 0;  ///< of these: mirror images in a wet road
  double weight_lost = 0;    ///< [returns] sum of 1 - trust
  DoubtCounts doubts;        ///< the phantoms by cause
  double share = 0;          ///< [-] of phantoms near the sensor, over the last scans
};

/// Separates phantoms from surfaces: writes LidarCloud::trust = 1 - P(phantom) of every return. One
/// instance per sensor, since it may keep state between scans.
class PointFilter {
 public:
  virtual ~PointFilter() = default;
  /// Uses `frame.ground`. No effect on a frame without a point cloud.
  virtual TrustStats apply(SensorFrame& frame) = 0;
  /// Of the last scan filtered, with its frame; empty where the filter does not count.
  virtual AirCensus census(const SensorFrame& frame) const {
    (void)frame;
    return {};
  }
  /// Why return `i` of the last scan filtered is doubted; empty: it is not, or the filter does not
  /// know.
  virtual std::optional<Doubt> doubtAbout(std::uint32_t i) const {
    (void)i;
    return std::nullopt;
  }
};

/// [weather], [weather.trust] and [weather.multipath].
struct WeatherParams {
  std::string filter = "off";  ///< or "trust" (docs/decisions/lidar.md)
  TrustParams trust;
  MultipathParams multipath;

  static WeatherParams read(Config& config);
  void visit(ParamVisitor& v);  ///< [weather] alone
};

/// The model of [weather.trust], followed by the test for mirror images; empty when off.
std::unique_ptr<PointFilter> makePointFilter(const WeatherParams& params);

}  // namespace perception
