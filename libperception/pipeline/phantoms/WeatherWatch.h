#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/weather/PointFilter.h"
#include "libperception/weather/state/WeatherState.h"

namespace perception {

/// What a lidar scan showed of the weather, and what was done about it.
struct WeatherRow {
  Stamp stamp;
  std::string sensor;
  WeatherState state;
  TrustStats trust;
};

/// Estimates the weather with every lidar whose returns are weighed ([weather] filter = trust), and
/// reports changes of its type.
class WeatherWatch {
 public:
  explicit WeatherWatch(EventLog& events) : events_(events) {}

  /// A scan, in order of time.
  void add(const std::string& sensor, Stamp stamp, const AirCensus& census,
           const TrustStats& trust);
  /// Mean of the lidars with a scan in the last second.
  std::array<double, kWeatherTypes> probabilities() const;
  double clear() const { return clear_; }  ///< probability of clear air at the last scan
  /// P(the air is not clear) at this lidar's last scan; 0 for one whose returns are not weighed.
  double notClear(const std::string& sensor) const;
  /// The clouds that this lidar sees near by, from its pose at the last scan; null: none that is
  /// likelier than its weather.
  std::shared_ptr<const AirClouds> clouds(const std::string& sensor,
                                          const Pose3& T_world_sensor) const;
  double fog() const { return fog_; }  ///< probability of fog at the last scan
  /// Rows since the last call.
  std::vector<WeatherRow> take();

 private:
  struct Lidar {
    WeatherEstimator estimator;
    Stamp stamp;
    double not_clear = 0;
  };
  EventLog& events_;
  std::map<std::string, Lidar> lidars_;
  Stamp now_;
  double clear_ = 1, fog_ = 0;
  WeatherType reported_ = WeatherType::kClear;
  std::vector<WeatherRow> rows_;
};

/// weather.csv: a line per lidar scan (libperception/README.md).
class WeatherFile {
 public:
  /// Throws OutputError.
  WeatherFile(const std::string& path, Stamp first_stamp);
  void write(const WeatherRow& row);
  void close() { file_.close(); }

 private:
  OutputFile file_;
  Stamp first_stamp_;
};

}  // namespace perception
