#include "studies/StudyApp.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>

#include "libperception/app/Programs.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/ReportFolders.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "studies/association/ParticlesStudy.h"
#include "studies/labels/LabelsStudy.h"
#include "studies/paper/MonteCarloStudy.h"
#include "studies/weather/SnowRealismStudy.h"

namespace perception {
namespace {

struct Study {
  const char* name;
  const char* description;
  StudyReport (*run)(StudyApp& app);
  void (*declare)(CLI::App& cli, StudyApp& app) = nullptr;  ///< options of its own
};

const Study kStudies[] = {
    {"monte-carlo", "pedestrians and cyclists classified by filter innovations (simulated)",
     [](StudyApp& app) {
       MonteCarloParams p;
       p.seed = app.seed;
       if (app.runs > 0) p.repeats = app.runs;
       return monteCarloStudy(p);
     }},
    {"particles", "number of objects by particles and birth model (simulated street)",
     [](StudyApp& app) {
       ParticlesParams p;
       if (app.runs > 0) p.scenes = app.runs;
       return particlesStudy(p);
     }},
    {"labels", "a detector's labels dropped or flipped: joint tracker and one per class (rawlogs)",
     [](StudyApp& app) { return app.labelsOfLogs(); },
     [](CLI::App& cli, StudyApp& app) { app.declareLabels(cli); }},
    {"resolution", "effect of a panorama's resolution: the camera tables of Radecki et al.",
     [](StudyApp& app) {
       app.resolution.seed = app.seed;
       return resolutionStudy(app.resolution);
     },
     [](CLI::App& cli, StudyApp& app) { declareResolution(cli, app.resolution); }},
    {"paper", "every table of Radecki et al. beside its own numbers (simulated)",
     [](StudyApp& app) {
       app.paper.site.seed = app.seed;
       return paperStudy(app.paper);
     },
     [](CLI::App& cli, StudyApp& app) { declarePaper(cli, app.paper); }},
    {"trust", "trust of lidar returns against labels of points (a rawlog)",
     [](StudyApp& app) { return trustStudy(app.trust); },
     [](CLI::App& cli, StudyApp& app) { declareTrust(cli, app.trust); }},
    {"safety", "false and missed stops, phantom tracks, against labels of points (rawlogs)",
     [](StudyApp& app) { return safetyStudy(app.safety, app.seed); },
     [](CLI::App& cli, StudyApp& app) { declareSafety(cli, app.safety); }},
    {"obstacles",
     "stops for shapes that no detector was taught, against the stopping distance (simulated)",
     [](StudyApp& app) { return obstaclesStudy(app.obstacles, app.seed); },
     [](CLI::App& cli, StudyApp& app) { declareObstacles(cli, app.obstacles); }},
    {"weather", "type and rates of the weather by lidar scans (rawlogs, simulated weather)",
     [](StudyApp& app) { return weatherStudy(app.weather, app.seed); },
     [](CLI::App& cli, StudyApp& app) { declareWeather(cli, app.weather); }},
    {"snow-realism", "whether a forest tells simulated from recorded snow (labelled rawlogs)",
     [](StudyApp& app) { return app.snowOfLogs(); },
     [](CLI::App& cli, StudyApp& app) { app.declareSnow(cli); }},
};

}  // namespace

void StudyApp::declare(CLI::App& cli) {
  cli.require_subcommand(1);
  for (const Study& s : kStudies) {
    CLI::App* sub = cli.add_subcommand(s.name, s.description);
    sub->add_option("-o,--output", output, "Folder of the report")->required();
    sub->add_option("--seed", seed, "Seed of all random numbers")->capture_default_str();
    sub->add_option("--runs", runs, "Experiments or simulated runs; 0 = the study's own number")
        ->check(CLI::Range(0, 1000000));
    sub->add_option("--threads", threads, "Number of threads; 0 = as many as the machine has")
        ->check(CLI::Range(0, 4096));
    if (s.declare) s.declare(*sub, *this);
    sub->callback([this, name = std::string(s.name)] { study = name; });
  }
}

void StudyApp::declareLabels(CLI::App& sub) {
  sub.add_option("-i,--input", inputs, "Rawlogs with boxes of a detector, LOG.truth.csv beside")
      ->required();
  sub.add_option("-c,--config", config_file, "INI whose sensors take boxes without a label, too")
      ->required();
  sub.add_option("--set", settings, "Change one value of the configuration: section.key=value");
  sub.add_option("--seconds", seconds, "Of every log; 0 = all")->check(CLI::Range(0.0, 1e6));
  sub.add_option("--range", range, "Truth counts up to this distance [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1e4));
  sub.add_option("--fov-deg", fov_deg, "Whole angle ahead in which truth counts [deg]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 360.0));
}

void StudyApp::declareSnow(CLI::App& sub) {
  sub.add_option("-i,--input", inputs,
                 "Rawlogs with LOG_Labels beside: recorded snow, then simulated snow")
      ->required()
      ->expected(2, 1000);
  sub.add_option("--snow-mm-h", snow_mm_h, "Rate [mm/h] whose flakes the control has")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 100.0));
}

void StudyApp::run() {
  const auto s = std::find_if(std::begin(kStudies), std::end(kStudies),
                              [&](const Study& x) { return x.name == study; });
  if (s == std::end(kStudies)) throw Error(ExitCode::kUsage, "no study '" + study + "'");
  std::optional<tbb::global_control> limit;
  if (threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  out_report = s->run(*this);
  for (const std::string& fault : writeStudyReport(out_report, output)) warn(fault);
  fmt::print("{}\nReport: {}/report.md\n", markdownOf(out_report), output);
}

StudyReport StudyApp::labelsOfLogs() {
  registerPerceptionClasses();
  LabelsParams params;
  params.seed = seed;
  params.evaluation.selection.range = range;
  params.evaluation.selection.fov = radians(fov_deg);
  std::vector<LabeledLog> logs;
  for (const std::string& file : inputs) {
    LabeledLog entry;
    entry.name = std::filesystem::path(file).stem().string();
    entry.truth = truthBeside(file);
    entry.record = [this, file](const LabeledLog::Edit& edit) {
      Config config = loadConfig();
      return recordLog(file, config, seconds, [&](mrpt::obs::CObservation& observation) {
        auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation);
        const auto stamp = toStamp(observation.timestamp);
        if (boxes && stamp) edit(boxes->detections, *stamp);
      });
    };
    logs.push_back(std::move(entry));
  }
  return labelsStudy(params, logs);
}

StudyReport StudyApp::snowOfLogs() {
  SnowRealismParams params;
  params.seed = seed;
  params.plain_mm_h = snow_mm_h;
  std::vector<SnowLog> logs;
  for (const std::string& file : inputs)
    logs.push_back(
        {std::filesystem::path(file).stem().string(), readSnowScans(file, params.sector)});
  return snowRealismStudy(params, logs.front(), {logs.begin() + 1, logs.end()});
}

std::unique_ptr<App> studyApp() { return std::make_unique<StudyApp>(); }

}  // namespace perception
