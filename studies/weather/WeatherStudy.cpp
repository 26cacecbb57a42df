#include "studies/weather/WeatherStudy.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <optional>

#include "libperception/core/Error.h"
#include "studies/weather/DrawnInstruments.h"
#include "studies/weather/WeatherLogs.h"

namespace perception {
namespace {

using Precipitation = SimulatedWeatherParams::Precipitation;

constexpr double kSettled = 5;            // [s] of a log after which type and rate are judged
constexpr std::size_t kInstruments = 10;  // that are drawn for each log and rate of snow
constexpr double kEnough = kSettled + 1;  // [s] of the log for each of them
constexpr double kRain[] = {1, 2, 5, 10, 25, 50}, kSnow[] = {0.5, 1, 2.5, 5};  // [mm/h]

/// Types of the scans of a log.
struct TypeCount {
  std::size_t scans = 0, right = 0, settled = 0, settled_right = 0;
  std::array<std::size_t, kWeatherTypes> of{};
  std::optional<double> since;  // [s] from here on all are right

  TypeCount& operator+=(const TypeCount& other) {
    scans += other.scans, right += other.right;
    settled += other.settled, settled_right += other.settled_right;
    for (std::size_t k = 0; k < kWeatherTypes; ++k) of[k] += other.of[k];
    return *this;
  }
};

TypeCount countTypes(const std::vector<WeatherRow>& rows, WeatherType truth) {
  TypeCount count;
  for (const WeatherRow& row : rows) {
    const double t = row.stamp - rows.front().stamp;
    const WeatherType type = row.state.type();
    ++count.scans, ++count.of[static_cast<std::size_t>(type)];
    const bool right = type == truth;
    count.right += right;
    if (t > kSettled) ++count.settled, count.settled_right += right;
    if (!right) count.since.reset();
    if (right && !count.since) count.since = t;
  }
  return count;
}

/// Light, moderate or heavy: rain above 2.5 and 7.6 mm/h [ams2012].
int classOfRain(double mm_h) { return mm_h > 7.6 ? 2 : mm_h > 2.5 ? 1 : 0; }

/// Errors of a rate over scans.
struct RateErrors {
  std::size_t scans = 0, covered = 0, within = 0, class_right = 0;
  double sum = 0, square = 0;

  void add(const Estimate& e, double truth) {
    ++scans;
    covered += e.low <= truth && truth <= e.high;
    within += e.value <= 1.5 * truth && truth <= 1.5 * e.value;
    class_right += classOfRain(e.value) == classOfRain(truth);
    sum += e.value, square += (e.value - truth) * (e.value - truth);
  }
  RateErrors& operator+=(const RateErrors& o) {
    scans += o.scans, covered += o.covered, within += o.within;
    class_right += o.class_right;
    sum += o.sum, square += o.square;
    return *this;
  }
  double share(std::size_t n) const {
    return scans > 0 ? static_cast<double>(n) / static_cast<double>(scans) : 0;
  }
  double perScan(double total) const { return scans > 0 ? total / static_cast<double>(scans) : 0; }
};

std::string weatherPercent(std::size_t part, std::size_t whole) {
  if (whole == 0) return "n/a";
  return fmt::format("{:.1f}", 100 * static_cast<double>(part) / static_cast<double>(whole));
}

std::vector<std::string> typeRow(const std::string& name, const char* truth,
                                 const TypeCount& count) {
  std::vector<std::string> row = {name, truth, fmt::format("{}", count.scans)};
  for (const std::size_t n : count.of) row.push_back(fmt::format("{}", n));
  row.push_back(weatherPercent(count.right, count.scans));
  row.push_back(weatherPercent(count.settled_right, count.settled));
  row.push_back(count.since ? fmt::format("{:.1f}", *count.since) : "");
  return row;
}

std::vector<std::string> rateRow(const std::vector<std::string>& head, const RateErrors& e) {
  std::vector<std::string> row = head;
  row.push_back(fmt::format("{}", e.scans));
  row.push_back(fmt::format("{:.2f}", e.perScan(e.sum)));
  row.push_back(fmt::format("{:.2f}", std::sqrt(e.perScan(e.square))));
  row.push_back(fmt::format("{:.0f}", 100 * e.share(e.within)));
  row.push_back(fmt::format("{:.0f}", 100 * e.share(e.covered)));
  row.push_back(head[1] == nameOf(WeatherType::kRain)
                    ? fmt::format("{:.0f}", 100 * e.share(e.class_right))
                    : "");
  return row;
}

const std::vector<std::string> kTypeColumns = {
    "log",     "weather",           "scans",          "clear", "rain", "snow", "fog",
    "right %", "right after 5 s %", "right from s on"};

StudyTable recordingsTable(const std::vector<WeatherLog>& logs, std::uint64_t seed) {
  StudyTable table = {"recordings", "Type by scan of the logs as they are", kTypeColumns, {}};
  TypeCount clear;
  for (const WeatherLog& log : logs) {
    const TypeCount count = countTypes(weatherOf(log, nullptr, seed), log.type);
    table.rows.push_back(typeRow(log.name(), nameOf(log.type), count));
    if (log.type == WeatherType::kClear) clear += count;
  }
  if (clear.scans > 0) table.rows.push_back(typeRow("all clear ones", "clear", clear));
  return table;
}

RateErrors errorsOf(const std::vector<WeatherRow>& rows, WeatherType type, double mm_h) {
  RateErrors errors;
  for (const WeatherRow& row : rows) {
    if (row.stamp - rows.front().stamp <= kSettled) continue;
    errors.add(type == WeatherType::kRain ? row.state.rain_mm_h : row.state.snow_mm_h, mm_h);
  }
  return errors;
}

const std::vector<std::string> kRateColumns = {
    "log",          "weather", "true",          "scans",
    "mean",         "RMSE",    "within 1.5x %", "90 % limits hold %",
    "class right %"};

/// Snow of the second generator seen by lidars that are drawn: limits that stand for what is not
/// known of the instrument cannot be judged by one instrument.
StudyTable instrumentsTable(const std::vector<WeatherLog>& logs, std::uint64_t seed) {
  StudyTable table = {"particles_instruments",
                      "Rate of snow after 5 s [mm/h], simulated: second generator, beam and flakes "
                      "known to a tenth",
                      kRateColumns,
                      {}};
  const auto drawn = drawnInstruments(logs.size() * std::size(kSnow) * kInstruments, seed);
  auto lidar = drawn.begin();
  RateErrors all;
  for (const WeatherLog& log : logs) {
    for (const double mm_h : kSnow) {
      RateErrors errors;
      for (std::size_t k = 0; k < kInstruments; ++k, ++lidar) {
        SimulatedWeatherParams weather =
            precipitationOf(WeatherType::kSnow, mm_h, Precipitation::kParticles);
        weather.beam_divergence_mrad = lidar->divergence_mrad;
        weather.flake_reflectivity = lidar->flake_reflectivity;
        errors += errorsOf(weatherOf(log, &weather, seed + k, kEnough), WeatherType::kSnow, mm_h);
      }
      if (errors.scans > 0)
        table.rows.push_back(rateRow({log.name(), "snow", fmt::format("{:g}", mm_h)}, errors));
      all += errors;
    }
  }
  table.rows.push_back(rateRow({"all", "snow", ""}, all));
  return table;
}

/// Precipitation put on clear logs.
class ThroughWeather {
 public:
  ThroughWeather(Precipitation generator, std::uint64_t seed)
      : generator_(generator), seed_(seed) {}

  void pass(const WeatherLog& log, WeatherType type, double mm_h) {
    const SimulatedWeatherParams weather = precipitationOf(type, mm_h, generator_);
    const std::vector<WeatherRow> rows = weatherOf(log, &weather, seed_);
    const bool rain = type == WeatherType::kRain;
    const std::string name = fmt::format("{}, {} {:g}", log.name(), nameOf(type), mm_h);
    const TypeCount count = countTypes(rows, type);
    types_.push_back(typeRow(name, nameOf(type), count));
    (rain ? all_rain_ : all_snow_) += count;
    const RateErrors errors = errorsOf(rows, type, mm_h);
    if (errors.scans == 0) return;
    rates_.push_back(rateRow({log.name(), nameOf(type), fmt::format("{:g}", mm_h)}, errors));
    (rain ? rain_errors_ : snow_errors_) += errors;
  }

  void addTables(StudyReport& report) {
    const bool second = generator_ == Precipitation::kParticles;
    const std::string name = second ? "particles" : "measured_law";
    const std::string title = second ? "second generator (drops and flakes)" : "measured law";
    types_.push_back(typeRow("all", "rain", all_rain_));
    types_.push_back(typeRow("all", "snow", all_snow_));
    rates_.push_back(rateRow({"all", "rain", ""}, rain_errors_));
    rates_.push_back(rateRow({"all", "snow", ""}, snow_errors_));
    report.tables.push_back(
        {name + "_types", "Type, simulated weather: " + title, kTypeColumns, types_});
    report.tables.push_back({name + "_rates", "Rate after 5 s [mm/h], simulated weather: " + title,
                             kRateColumns, rates_});
  }

 private:
  Precipitation generator_;
  std::uint64_t seed_;
  std::vector<std::vector<std::string>> types_, rates_;
  TypeCount all_rain_, all_snow_;
  RateErrors rain_errors_, snow_errors_;
};

}  // namespace

void declareWeather(CLI::App& cli, WeatherOptions& o) {
  cli.add_option("-i,--input", o.logs,
                 "CONFIG=LOG=TYPE: rawlogs or scenario INIs, and their weather: clear, rain, snow, "
                 "fog");
  cli.add_option("--through", o.through,
                 "CONFIG=LOG: clear ones on which rain and snow of both generators are put");
}

StudyReport weatherStudy(const WeatherOptions& options, std::uint64_t seed) {
  if (options.logs.empty() && options.through.empty())
    throw Error(ExitCode::kUsage, "nothing to judge: give -i or --through");
  std::vector<WeatherLog> logs, through;
  for (const std::string& text : options.logs) logs.push_back(WeatherLog::parse(text));
  for (const std::string& text : options.through) through.push_back(WeatherLog::parse(text));
  StudyReport report;
  report.title = "Weather estimated from lidar scans";
  report.data =
      fmt::format("{} logs as they are, {} through simulated weather", logs.size(), through.size());
  if (!logs.empty()) report.tables.push_back(recordingsTable(logs, seed));
  for (const Precipitation generator : {Precipitation::kParticles, Precipitation::kMeasured}) {
    if (through.empty()) break;
    ThroughWeather weather(generator, seed);
    for (const WeatherLog& log : through) {
      for (const double mm_h : kRain) weather.pass(log, WeatherType::kRain, mm_h);
      for (const double mm_h : kSnow) weather.pass(log, WeatherType::kSnow, mm_h);
    }
    weather.addTables(report);
  }
  if (!through.empty()) report.tables.push_back(instrumentsTable(through, seed));
  report.remarks = {
      "The type is the most probable one after each scan. Rates are judged 5 s after the log's "
      "beginning and later, whatever type was found.",
      "Weather put on recordings and in scenarios is simulated, and so is what is said of it. The "
      "second generator has another law and another threshold than the one that the estimator's "
      "rates were made for, but its scans on two recordings were seen when thresholds were set.",
      fmt::format("The drawn lidars have a beam of 3 mrad and flakes of reflectivity 0.9, each "
                  "times a factor that is within 1.1 in 90 %: {} for each log and rate. The other "
                  "tables have one lidar, whose error is the same in every scan.",
                  kInstruments)};
  return report;
}

}  // namespace perception
