#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>

#include "libperception/app/App.h"
#include "libperception/app/Programs.h"
#include "libperception/calibration/CalibrationTasks.h"
#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/pictures/ReportFolders.h"

namespace perception {
namespace {

/// perception-calibrate: parameters for a vehicle's INI from rawlogs with truth, each with its
/// counts.
class CalibrateApp : public App {
 public:
  CalibrateApp()
      : App("perception-calibrate",
            "Fits lines of a vehicle's INI to rawlogs with truth (LOG.truth.csv beside "
            "LOG.rawlog); gains works without truth, too.") {}

  std::string task;                          ///< the subcommand
  std::uint64_t seed = 1;                    ///< --seed
  int rounds = 0;                            ///< tempering: --runs; 0 = default of the task
  double seconds = 0;                        ///< of every log; 0 = all
  double truth_range = 30, truth_fov = 360;  ///< tempering: sector in which truth counts [m, deg]
  LidarClassesOptions lidar_classes{{360}, false, "", "that of the logs", "not given"};
  bool no_truth = false;  ///< gains: --no-truth

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  struct Task;
  static const Task kTasks[];
  CalibrationInput input() const;
};

}  // namespace

struct CalibrateApp::Task {
  const char* name;
  const char* description;
  StudyReport (*run)(const CalibrateApp& app);
  bool search = false;     ///< repeats tracking; has options of the truth sector
  bool learns = false;     ///< leaves a model file
  bool truthless = false;  ///< may do without a truth
};

const CalibrateApp::Task CalibrateApp::kTasks[] = {
    {"tempering", "how far labels and innovations count in the class update",
     [](const CalibrateApp& app) {
       return calibrateTempering(app.input(), app.rounds, app.truth_range, radians(app.truth_fov));
     },
     true},
    {"boxes", "what the scores of a 3D detector's boxes say of objects, fitted",
     [](const CalibrateApp& app) { return calibrateBoxes(app.input()); }},
    {"confidence", "what those scores are worth and the output threshold: an INI",
     [](const CalibrateApp& app) { return calibrateConfidence(app.input()); }},
    {"learnt", "how true the odds of confidence = learnt are, and how soon",
     [](const CalibrateApp& app) { return calibrateLearnt(app.input()); }},
    {"detector", "detection, labels, clutter and noise of detectors, counted",
     [](const CalibrateApp& app) { return calibrateDetector(app.input()); }},
    {"gains",
     "detection, labels, clutter, births and noise of all sensors, with or without truth: an INI",
     [](const CalibrateApp& app) { return calibrateGains(app.input(), app.no_truth); }, false,
     false, true},
    {"lidar-classes", "what clusters of lidar returns look like, learned",
     [](const CalibrateApp& app) { return calibrateLidarClasses(app.input(), app.lidar_classes); },
     false, true},
};

void CalibrateApp::declare(CLI::App& cli) {
  cli.require_subcommand(1);
  for (const Task& t : kTasks) {
    CLI::App* sub = cli.add_subcommand(t.name, t.description);
    sub->add_option("-i,--input", inputs, "Rawlogs, with LOG.truth.csv beside each")->required();
    sub->add_option("-c,--config", config_file, "INI of the vehicle")->required();
    sub->add_option("-o,--output", output, "Folder of the report")->required();
    sub->add_option("--set", settings, "Change one value of the configuration: section.key=value");
    sub->add_option("--seconds", seconds, "Use so many seconds of every log; 0 = all")
        ->check(CLI::Range(0.0, 1e6));
    sub->add_option("--seed", seed, "Seed of all random numbers")->capture_default_str();
    sub->add_option("--threads", threads, "Number of threads; 0 = as many as the machine has")
        ->check(CLI::Range(0, 4096));
    if (t.search) {
      sub->add_option("--runs", rounds, "Rounds of the search; 0 = its own number")
          ->check(CLI::Range(0, 1000000));
      sub->add_option("--range", truth_range, "Truth counts up to this distance [m]")
          ->capture_default_str()
          ->check(CLI::Range(0.1, 1e4));
      sub->add_option("--fov-deg", truth_fov, "Whole angle ahead in which truth counts [deg]")
          ->capture_default_str()
          ->check(CLI::Range(0.1, 360.0));
    }
    if (t.truthless)
      sub->add_flag("--no-truth", no_truth, "Ignore the truth, even if there is one");
    if (t.learns) {
      sub->add_option("--complete-fov-deg", lidar_classes.complete_fov,
                      "Whole angle ahead in which the truth is complete [deg]: one for all logs, "
                      "or one per log")
          ->check(CLI::Range(1.0, 360.0));
      sub->add_flag("--model-only", lidar_classes.model_only,
                    "Learn the model without judging each log by the others: no tables");
      sub->add_option("--keep", lidar_classes.keep,
                      "Model file to keep: only the shapes that it knows are learned anew, from "
                      "recordings that it has learned from");
      sub->add_option("--license", lidar_classes.license,
                      "License that is written into the model file")
          ->capture_default_str();
      sub->add_option("--date", lidar_classes.date, "Date that is written into the model file");
    }
    sub->callback([this, name = std::string(t.name)] { task = name; });
  }
}

void CalibrateApp::run() {
  const auto t = std::find_if(std::begin(kTasks), std::end(kTasks),
                              [&](const Task& x) { return x.name == task; });
  if (t == std::end(kTasks)) throw Error(ExitCode::kUsage, "no task '" + task + "'");
  std::optional<tbb::global_control> limit;
  if (threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const StudyReport report = t->run(*this);
  for (const std::string& fault : writeStudyReport(report, output)) warn(fault);
  fmt::print("{}\nReport: {}/report.md\n", markdownOf(report), output);
}

CalibrationInput CalibrateApp::input() const {
  return {inputs, config_file, [this] { return loadConfig(); }, seconds, seed};
}

std::unique_ptr<App> calibrateApp() { return std::make_unique<CalibrateApp>(); }

}  // namespace perception
