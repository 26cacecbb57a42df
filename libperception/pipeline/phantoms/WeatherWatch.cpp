#include "libperception/pipeline/phantoms/WeatherWatch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

constexpr double kFreshWeather = 1;  // [s] for which a lidar's last scan counts; assumed
constexpr double kCertain = 0.8;     // probability from which a change of the weather is an event

std::string field(double value) { return fixedPlaces(value, 2); }

double roundedValue(double value) { return std::round(100 * value) / 100; }

std::string interval(const Estimate& e) {
  return field(e.value) + ',' + field(e.low) + ',' + field(e.high);
}

EventLog::Fields fieldsOf(const WeatherState& state, double probability) {
  EventLog::Fields fields = {{"type", nameOf(state.type())},
                             {"probability", roundedValue(probability)}};
  const auto add = [&](const char* name, const Estimate& e) {
    fields[name] = {roundedValue(e.low), roundedValue(e.value), roundedValue(e.high)};
  };
  if (state.type() == WeatherType::kRain) add("rain_mm_h", state.rain_mm_h);
  if (state.type() == WeatherType::kSnow) add("snow_mm_h", state.snow_mm_h);
  add("visibility", state.visibility);
  return fields;
}

}  // namespace

void WeatherWatch::add(const std::string& sensor, Stamp stamp, const AirCensus& census,
                       const TrustStats& trust) {
  Lidar& lidar = lidars_[sensor];
  lidar.estimator.add(census, stamp);
  lidar.stamp = now_ = stamp;
  WeatherState state = lidar.estimator.state();
  lidar.not_clear = state.notClear();
  rows_.push_back({stamp, sensor, state, trust});
  state.probability = probabilities();
  clear_ = state.of(WeatherType::kClear);
  fog_ = state.of(WeatherType::kFog);
  const WeatherType type = state.type();
  if (type == reported_ || state.of(type) < kCertain) return;
  reported_ = type;
  events_.add(stamp, event_kind::kWeather, fmt::format("{}: {}", sensor, nameOf(type)),
              fieldsOf(state, state.of(type)));
}

std::array<double, kWeatherTypes> WeatherWatch::probabilities() const {
  std::array<double, kWeatherTypes> mean{};
  double count = 0;
  for (const auto& [label, lidar] : lidars_) {
    if (now_ - lidar.stamp > kFreshWeather) continue;
    const auto p = lidar.estimator.state().probability;
    for (std::size_t k = 0; k < kWeatherTypes; ++k) mean[k] += p[k];
    ++count;
  }
  for (double& p : mean) p /= std::max(count, 1.0);
  return mean;
}

double WeatherWatch::notClear(const std::string& sensor) const {
  const auto found = lidars_.find(sensor);
  return found == lidars_.end() ? 0 : found->second.not_clear;
}

std::shared_ptr<const AirClouds> WeatherWatch::clouds(const std::string& sensor,
                                                      const Pose3& T_world_sensor) const {
  const auto found = lidars_.find(sensor);
  if (found == lidars_.end()) return nullptr;
  return found->second.estimator.clouds(T_world_sensor, found->second.not_clear);
}

std::vector<WeatherRow> WeatherWatch::take() { return std::exchange(rows_, {}); }

WeatherFile::WeatherFile(const std::string& path, Stamp first_stamp)
    : file_(path), first_stamp_(first_stamp) {
  file_.write(
      "t,stamp,sensor,type,p_clear,p_rain,p_snow,p_fog,rain,rain_low,rain_high,snow,snow_low,"
      "snow_high,visibility,visibility_low,visibility_high,returns,doubted,mirrored\n");
}

void WeatherFile::write(const WeatherRow& row) {
  const WeatherState& state = row.state;
  std::string line = decimalSeconds(row.stamp.ns - first_stamp_.ns) + ',' +
                     decimalSeconds(row.stamp.ns) + ',' + row.sensor + ',' + nameOf(state.type());
  for (const double p : state.probability) line += ',' + fixedPlaces(p, kProbabilityPlaces);
  line += ',' + interval(state.rain_mm_h) + ',' + interval(state.snow_mm_h) + ',' +
          interval(state.visibility);
  line += fmt::format(",{},{},{}\n", row.trust.returns, row.trust.phantoms - row.trust.mirrored,
                      row.trust.mirrored);
  file_.write(line);
}

}  // namespace perception
