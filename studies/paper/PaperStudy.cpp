#include "studies/paper/PaperStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/evaluation/tables/PaperTables.h"
#include "libperception/pipeline/output/Progress.h"
#include "studies/association/ParticlesStudy.h"
#include "studies/paper/MonteCarloStudy.h"
#include "studies/paper/PaperReport.h"
#include "studies/resolution/ResolutionStudy.h"

namespace perception {
namespace {

constexpr int kStreets = 40;  // of the second particle study: 9 s on four cores with 100

std::vector<PaperEncounter> encountersOf(const PaperOptions& options) {
  std::vector<std::string> scenarios = options.scenarios;
  if (scenarios.empty()) scenarios = {"A", "B", "C"};
  std::vector<PaperEncounter> all;
  for (int trial = 1; trial <= options.trials; ++trial) {
    for (const PaperWeather& weather : paperWeathers()) {
      const auto& wanted = options.weathers;
      if (!wanted.empty() && !std::count(wanted.begin(), wanted.end(), weather.name)) continue;
      for (const std::string& scenario : scenarios) all.push_back({scenario, weather, trial});
    }
  }
  return all;
}

std::vector<PaperOutcome> run(const PaperOptions& options) {
  const std::vector<PaperEncounter> encounters = encountersOf(options);
  std::vector<PaperOutcome> outcomes(encounters.size());
  Progress progress("paper", encounters.size());
  std::atomic<std::uint64_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, encounters.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          // A waiting thread must not start another one: MRPT resamples with the thread's
          // generator.
          tbb::this_task_arena::isolate(
              [&] { outcomes[i] = runPaperEncounter(options.site, encounters[i]); });
          ++done;
        }
      },
      tbb::simple_partitioner());
  progress.update(done, done);
  return outcomes;
}

void append(StudyReport part, const std::string& prefix, StudyReport& report) {
  for (StudyTable& table : part.tables) {
    table.name = prefix + "_" + table.name;
    table.title += "; " + part.data;
    report.tables.push_back(std::move(table));
  }
}

/// Without a run: the published rates alone.
StudyTable resolutionNotRun() {
  StudyTable table = {
      "resolution_rates",
      "Objects detected a sensor return and tracked, by resolution; not run",
      {"sensors", "objects", "paper: objects", "cars", "paper: cars", "persons", "paper: persons"},
      {}};
  for (const PaperRateRow& row : paperRateRows()) {
    table.rows.push_back({row.sensors, "", fmt::format("{:.2f}", row.objects), "",
                          fmt::format("{:.2f}", row.cars), "", fmt::format("{:.2f}", row.persons)});
  }
  return table;
}

/// Positions of people and vehicles are recordings, and none of the paper's is at hand.
StudyTable gpsNotRun() {
  return {"gps",
          "Classes from positions at 1 Hz: not run, needs recordings (docs/decisions/formats.md)",
          {"class", "right", "paper: right"},
          {{"Pedestrian", "", "100 %"},
           {"Car", "", "99 %"},
           {"Bus", "", "99 %"},
           {"Cyclist", "", "50 %"}}};
}

}  // namespace

void declarePaper(CLI::App& cli, PaperOptions& o) {
  cli.add_option("--ini", o.site.ini, "Folder with scenarios/ and weather/")
      ->capture_default_str()
      ->check(CLI::ExistingDirectory);
  cli.add_option("-c,--config", o.site.config, "INI of the tracker; without it INI/skynet.ini")
      ->check(CLI::ExistingFile);
  cli.add_option("--trials", o.trials, "Of each scenario in each weather")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  cli.add_option("--scenarios", o.scenarios, "Without it A,B,C")->delimiter(',');
  std::vector<std::string> names;
  for (const PaperWeather& w : paperWeathers()) names.emplace_back(w.name);
  cli.add_option("--weathers", o.weathers, "Without it all; what is not run stays empty")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  cli.add_option("--seconds", o.site.seconds, "Of each encounter; 0 = all")
      ->check(CLI::Range(0.0, 1e6));
  cli.add_option("--resolution-seconds", o.resolution_seconds,
                 "Of the busy street of the tables of resolutions; 0: not run")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
}

StudyReport paperStudy(const PaperOptions& options) {
  StudyReport report;
  report.title = "The tables of Radecki et al. on simulated encounters";
  report.data = fmt::format(
      "simulated: scenarios {}, {} trials in each weather ({}), seed {}, tracker {}",
      options.scenarios.empty() ? "A, B, C" : fmt::format("{}", fmt::join(options.scenarios, ", ")),
      options.trials,
      options.weathers.empty() ? "all of ini/weather that the paper has"
                               : fmt::format("{}", fmt::join(options.weathers, ", ")),
      options.site.seed, options.site.vehicleConfig());
  report.tables = paperTables(run(options));

  if (options.resolution_seconds > 0) {
    ResolutionOptions resolution;
    resolution.site.file = options.site.vehicleConfig();
    resolution.scenario = options.site.ini + "/scenarios/busy_street.ini";
    resolution.seconds = options.resolution_seconds;
    resolution.seed = options.site.seed;
    append(resolutionStudy(resolution), "resolution", report);
  } else {
    report.tables.push_back(resolutionNotRun());
  }
  ParticlesParams streets;
  streets.scenes = std::min(kStreets, 8 * options.trials);
  append(particlesStudy(streets), "street", report);
  MonteCarloParams tracks;
  tracks.seed = options.site.seed;
  append(monteCarloStudy(tracks), "monte_carlo", report);
  report.tables.push_back(gpsNotRun());
  report.remarks = {
      "All of ours is simulated; the paper's numbers are of its recordings.",
      "Ours: all instants of the row pooled; ±: standard deviation over the trials, each with all "
      "scenarios and weathers of the row pooled.",
      "Tracked: share of the instants with the object ahead and within 20 m at which the closest "
      "estimate is within 2 m, however few returns the object has; for the camera the paper's "
      "denominator is a shorter one that it does not say (B and C are two readings).",
      "An empty cell was not run, or is not in the paper.",
      "The tracker's INI is the same in every weather. The lidar's background light by night is no "
      "part of the simulation.",
      "Table of process noise: inputs of the filter, not results."};
  return report;
}

}  // namespace perception
