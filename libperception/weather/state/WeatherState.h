#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/weather/state/AirCensus.h"
#include "libperception/weather/state/PrecipitationRate.h"

namespace perception {

enum class WeatherType { kClear, kRain, kSnow, kFog };
constexpr std::size_t kWeatherTypes = 4;
const char* nameOf(WeatherType type);  ///< clear, rain, snow, fog

/// The weather as one lidar sees it (method.md 9.10).
struct WeatherState {
  std::array<double, kWeatherTypes> probability{1, 0, 0, 0};  ///< in the order of WeatherType
  /// [0, 1] P(the air is not clear) by the returns in free air of the last second alone: a flurry
  /// is there at once, while the weather waits for more.
  double flurry = 0;
  Estimate rain_mm_h, snow_mm_h;  ///< if it rains, if it snows [mm/h of water]
  Estimate visibility;            ///< [m] meteorological optical range; without fog: at least

  /// The most probable type.
  WeatherType type() const;
  double of(WeatherType t) const { return probability[static_cast<std::size_t>(t)]; }
  /// [0, 1] P(returns may be of the air itself): the greater one of both.
  double notClear() const { return std::max(1 - of(WeatherType::kClear), flurry); }
};

/// Estimates the weather from a lidar's scans: clear, precipitation or fog by a hidden Markov model
/// of the returns in free air and of the reach; rain or snow, rates and visibility from their
/// means over the last seconds (method.md 9.10). It changes nothing else.
class WeatherEstimator {
 public:
  /// Scans in order of time; after a gap of 5 s it starts anew.
  void add(const AirCensus& census, Stamp stamp);
  WeatherState state() const;
  /// The clouds that the lidar sees near by, in the last scan or in the last second, for a scan
  /// from that pose; null: none is likelier than `weather`, P(the air is not clear), or than
  /// hardly.
  std::shared_ptr<const AirClouds> clouds(const Pose3& T_world_sensor, double weather) const;

 private:
  /// What scans showed lately: means that forget.
  struct Means {
    std::array<AirCensus::Sector, AirCensus::kSectors> sectors{};
    double above24 = 0, within24 = 0;            ///< returns beyond 24 m, and nearer
    double ground_reach = 0, upright_reach = 0;  ///< [m] 99 % quantiles
  };
  /// What is told from them.
  struct Signs {
    std::array<double, AirCensus::kShellCount> lone{};  ///< share of the beams, by shell
    double level = 1;                                   ///< [0, 1] share of level beams that return
    double reach = 0;                                   ///< [m]
    double open = 0;                                    ///< share of returns beyond 24 m
    bool any = false;                                   ///< enough of the surroundings is seen
  };
  void restart();
  void blend(const AirCensus& census, bool first, double dt);
  Signs signsOf(const Means& means) const;
  /// The sectors into which the sensor looks.
  std::vector<const AirCensus::Sector*> looksOf(const Means& means) const;
  /// What the beams met in the last ten seconds, whose signs are given.
  AirShares sharesOf(const Signs& signs) const;
  /// [log-likelihood ratio] of returns from the air to clear air, unbounded.
  static double airOf(const Signs& signs);
  /// [log-likelihood] of clear air, precipitation and fog by one look.
  static std::array<double, 3> evidenceOf(const Signs& signs);
  void follow(const Signs& signs, double dt);

  std::optional<Stamp> last_;
  Means brief_, long_;                                        ///< of a second and of ten
  std::array<AirCensus::Sector, AirCensus::kSectors> now_{};  ///< of the last scan
  std::array<double, AirCensus::kSectors> seen_{};            ///< most returns of a scan
  double most_level_ = 0;
  std::array<double, 3> log_p_{};  ///< logs of the probabilities: clear, precipitation, fog
  PrecipitationRate rates_;
};

}  // namespace perception
