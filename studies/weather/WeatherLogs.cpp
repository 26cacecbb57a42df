#include "studies/weather/WeatherLogs.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "libperception/core/Error.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/recorded/RecordedScene.h"
#include "libperception/simulation/recorded/WeatheredLog.h"

namespace perception {
namespace {

using Observation = std::shared_ptr<mrpt::obs::CObservation>;
using Source = std::function<Observation()>;  // null: the end

Source logOf(const std::string& file) {
  auto reader = std::make_shared<RawlogReader>(file);
  return [reader] { return reader->next(); };
}

/// The vehicle's way, for where weather meets the road.
Scenario sceneOf(const std::string& file, Stamp& first) {
  RawlogReader reader(file);
  EgoPose ego;
  std::vector<RecordedPose> poses;
  std::optional<Stamp> begin, end;
  while (const auto observation = reader.next()) {
    const auto stamp = toStamp(observation->timestamp);
    if (!stamp) continue;
    if (!begin) begin = stamp;
    end = stamp;
    ego.add(*observation);
    if (const auto state = ego.at(*stamp)) poses.push_back({*stamp - *begin, state->T_world_ego});
  }
  if (!begin) throw DataError(file + ": no observation with a stamp");
  first = *begin;
  return recordedScene({}, poses, *end - *begin);
}

Source weatheredLog(const std::string& file, const SimulatedWeatherParams& weather,
                    std::uint64_t seed) {
  Stamp first;
  Scenario scene = sceneOf(file, first);
  scene.weather = weather;
  auto altered = std::make_shared<WeatheredLog>(std::move(scene), first, seed, 0);
  return [source = logOf(file), altered]() -> Observation {
    while (const auto observation = source())
      if (auto result = altered->apply(observation)) return result;
    return nullptr;
  };
}

Source playedScenario(const std::string& file, const SimulatedWeatherParams* weather,
                      std::uint64_t seed) {
  Config config = Config::fromFile(file);
  Scenario scenario = readScenario(config);
  config.finish();
  if (weather != nullptr) scenario.weather = *weather;
  auto simulator = std::make_shared<Simulator>(std::move(scenario), "weather study", seed, 0);
  return [simulator] { return simulator->next(); };
}

}  // namespace

WeatherLog WeatherLog::parse(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == '=')
      parts.emplace_back();
    else
      parts.back().push_back(c);
  }
  WeatherLog log;
  if (parts.size() < 2 || parts.size() > 3 || parts[0].empty() || parts[1].empty())
    throw Error(ExitCode::kUsage, "'" + text + "': expected CONFIG=LOG or CONFIG=LOG=TYPE");
  log.config = parts[0], log.log = parts[1];
  if (parts.size() == 2) return log;
  constexpr WeatherType kTypes[] = {WeatherType::kClear, WeatherType::kRain, WeatherType::kSnow,
                                    WeatherType::kFog};
  const auto type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                 [&](WeatherType t) { return parts[2] == nameOf(t); });
  if (type == std::end(kTypes))
    throw Error(ExitCode::kUsage, "'" + text + "': the type is clear, rain, snow or fog");
  log.type = *type;
  return log;
}

std::string WeatherLog::name() const { return std::filesystem::path(log).stem().string(); }

bool WeatherLog::isScenario() const { return std::filesystem::path(log).extension() == ".ini"; }

SimulatedWeatherParams precipitationOf(WeatherType type, double mm_h,
                                       SimulatedWeatherParams::Precipitation generator) {
  SimulatedWeatherParams weather;
  weather.precipitation = generator;
  weather.sky = SimulatedWeatherParams::Sky::kCloudy;
  if (type == WeatherType::kRain) weather.rain_mm_h = mm_h, weather.water_film_mm = 0.6;
  if (type == WeatherType::kSnow) weather.snow_mm_h = mm_h, weather.snow_cover = 0.8;
  return weather;
}

std::vector<WeatherRow> weatherOf(const WeatherLog& log, const SimulatedWeatherParams* weather,
                                  std::uint64_t seed, double until) {
  registerPerceptionClasses();
  const Source source = log.isScenario()     ? playedScenario(log.log, weather, seed)
                        : weather != nullptr ? weatheredLog(log.log, *weather, seed)
                                             : logOf(log.log);
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(forFrontEnds(PipelineSetup::fromFile(log.config, {"weather.filter=trust"})),
                    events, timing);
  std::vector<WeatherRow> rows;
  const auto take = [&](bool end) {
    while (pipeline.next(end)) continue;
    for (WeatherRow& row : pipeline.takeWeather()) rows.push_back(std::move(row));
  };
  std::optional<Stamp> first;
  while (const auto observation = source()) {
    stopIfAsked();
    const auto stamp = toStamp(observation->timestamp);
    if (!first) first = stamp;
    if (stamp && *stamp - *first > until) break;
    pipeline.add(*observation);
    take(false);
  }
  take(true);
  if (rows.empty()) throw DataError(log.log + ": no scan of a lidar in use by " + log.config);
  return rows;
}

}  // namespace perception
