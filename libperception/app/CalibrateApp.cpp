#include "libperception/app/CalibrateApp.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "libperception/app/Programs.h"
#include "libperception/app/StudyFolder.h"
#include "libperception/boxes3d/PositionFrontEnd.h"
#include "libperception/calibration/TemperingStudy.h"
#include "libperception/calibration/TracksAsTruth.h"
#include "libperception/calibration/clusters/ClusterStudy.h"
#include "libperception/calibration/detectors/ConfidenceStudy.h"
#include "libperception/calibration/detectors/DetectorStudy.h"
#include "libperception/calibration/detectors/LearntStudy.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace {

bool hasSpaceBoxes(const ObjectDetections& detections) {
  return std::any_of(detections.objects.begin(), detections.objects.end(),
                     [](const auto& o) { return o.space_box.has_value(); });
}

/// Of confidence = learnt for this configuration.
ConfidenceLearner learnerOf(const std::string& sensor, Config config) {
  const std::string section = "sensor." + sensor;
  return ConfidenceLearner(learnerParams(config.read<PositionParams>(section + ".positions"),
                                         config.read<DetectionParams>(section)));
}

}  // namespace

struct CalibrateApp::Task {
  const char* name;
  const char* description;
  StudyReport (CalibrateApp::*run)();
  bool search = false;  ///< repeats tracking; has options of the truth sector
  bool learns = false;  ///< leaves a model file
};

const CalibrateApp::Task CalibrateApp::kTasks[] = {
    {"tempering", "how far labels and innovations count in the class update",
     &CalibrateApp::tempering, true},
    {"boxes", "what the scores of a 3D detector's boxes say of objects, fitted",
     &CalibrateApp::boxes},
    {"confidence", "what those scores are worth and the output threshold: an INI",
     &CalibrateApp::confidence},
    {"learnt", "how true the odds of confidence = learnt are, and how soon", &CalibrateApp::learnt},
    {"detector", "detection, labels, clutter and noise of detectors, counted",
     &CalibrateApp::detector},
    {"gains",
     "detection, labels, clutter, births and noise of all sensors, with or without truth: an INI",
     &CalibrateApp::gains},
    {"lidar-classes", "what clusters of lidar returns look like, learned",
     &CalibrateApp::lidarClasses, false, true},
};

std::string CalibrateApp::description() const {
  return "Fits lines of a vehicle's INI to rawlogs with truth (LOG.truth.csv beside LOG.rawlog); "
         "gains works without truth, too.";
}

void CalibrateApp::declare(CLI::App& cli) {
  cli.require_subcommand(1);
  for (const Task& t : kTasks) {
    CLI::App* sub = cli.add_subcommand(t.name, t.description);
    sub->add_option("-i,--input", inputs, "Rawlogs, with LOG.truth.csv beside each")->required();
    sub->add_option("-c,--config", config_file, "INI of the vehicle")->required();
    sub->add_option("-o,--output", output, "Folder of the report")->required();
    sub->add_option("--set", settings, "section.key=value: overrides the INI");
    sub->add_option("--seconds", seconds, "Use so many seconds of every log; 0 = all")
        ->check(CLI::Range(0.0, 1e6));
    sub->add_option("--seed", seed, "Seed of all random numbers")->capture_default_str();
    sub->add_option("--threads", threads, "Threads; 0 = as many as the machine has")
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
    if (t.run == &CalibrateApp::gains)
      sub->add_flag("--no-truth", no_truth, "Ignore the truth, even if there is one");
    if (t.learns) {
      sub->add_option("--complete-fov-deg", complete_fov,
                      "Whole angle ahead in which the truth is complete [deg]: one for all logs, "
                      "or one per log")
          ->check(CLI::Range(1.0, 360.0));
      sub->add_flag("--variants", variants,
                    "Learn from every scan also as other sensors would have made it");
      sub->add_flag("--model-only", model_only,
                    "Learn the model without judging each log by the others: no tables");
      sub->add_option("--license", license, "License that is written into the model file")
          ->capture_default_str();
      sub->add_option("--date", date, "Date that is written into the model file");
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
  out_report = (this->*t->run)();
  for (const std::string& fault : writeStudyReport(out_report, output)) warn(fault);
  fmt::print("{}\nReport: {}/report.md\n", markdownOf(out_report), output);
}

StudyReport CalibrateApp::tempering() {
  TemperingParams params;
  params.seed = seed;
  if (rounds > 0) params.rounds = rounds;
  params.evaluation.selection.min_points = 5;  // poles are thin
  params.evaluation.selection.range = truth_range;
  params.evaluation.selection.fov = radians(truth_fov);
  std::vector<TemperingLog> logs;
  for (const std::string& file : inputs) {
    Config config = loadConfig();
    logs.push_back({recordLog(file, config, seconds), truthBeside(file)});
    params.particles = logs.back().log.particles.sample_size;
  }
  return temperingStudy(params, logs);
}

CalibrateApp::JudgedLogs CalibrateApp::judgedBoxes(bool learning) {
  registerPerceptionClasses();
  JudgedLogs judged;
  for (const std::string& file : inputs) {
    std::map<Stamp, ObjectDetections> seen;
    Config config = loadConfig();
    const RecordedLog log =
        recordLog(file, config, seconds, [&](mrpt::obs::CObservation& observation) {
          const auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation);
          const auto stamp = toStamp(observation.timestamp);
          if (!boxes || !hasSpaceBoxes(boxes->detections) || !stamp) return;
          judged.sensor = observation.sensorLabel;
          seen[*stamp] = boxes->detections;
        });
    std::optional<ConfidenceLearner> learner;
    if (learning) learner = learnerOf(judged.sensor, loadConfig());
    judged.logs.push_back(
        boxLog(log, judged.sensor, seen, truthBeside(file), learner ? &*learner : nullptr));
  }
  for (const std::string& name :
       loadConfig().read<PositionParams>("sensor." + judged.sensor + ".positions").names) {
    const auto equals = name.find('=');
    judged.names[name.substr(0, equals)] = name.substr(equals + 1);
  }
  return judged;
}

StudyReport CalibrateApp::boxes() {
  const JudgedLogs judged = judgedBoxes();
  return boxEvidenceStudy(judged.sensor, judged.logs, judged.names);
}

StudyReport CalibrateApp::confidence() {
  JudgedLogs judged = judgedBoxes();
  const auto view = loadConfig().read<DetectionParams>("sensor." + judged.sensor);
  ConfidenceInput input;
  input.sensor = judged.sensor;
  input.names = std::move(judged.names);
  input.clutter_per_scan = view.clutter_per_scan;
  input.logs = std::move(judged.logs);
  for (const std::string& file : inputs) input.truths.push_back(truthBeside(file));
  input.evaluation.selection.min_points = 0;  // logs of boxes have no returns
  input.evaluation.selection.range = view.range_max;
  input.evaluation.selection.fov = input.evaluation.selection.complete_fov = view.fov;
  input.evaluation.exclusion = input.evaluation.tolerance;
  input.track = [&](std::size_t log, const ScoreKeys& keys) {
    Config config = loadConfig();
    const std::string section = "sensor." + input.sensor + ".positions.";
    config.set(section + "confidence=fitted");
    for (const auto& [key, value] : keys) config.set(section + key + "=" + value);
    RecordedLog recorded = recordLog(inputs[log], config, seconds);
    recorded.scene.min_existence = leastExistence();
    return replay(recorded, {recorded.model.proposal, recorded.particles.sample_size, seed});
  };
  return confidenceStudy(input, std::filesystem::absolute(config_file).string());
}

/// Logs of one folder are of one detector.
StudyReport CalibrateApp::learnt() {
  JudgedLogs judged = judgedBoxes(true);
  std::vector<LearntGroup> groups;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string folder =
        std::filesystem::absolute(inputs[i]).parent_path().filename().string();
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const LearntGroup& g) { return g.name == folder; });
    if (group == groups.end()) group = groups.insert(group, {folder, {}});
    group->logs.push_back(std::move(judged.logs[i]));
  }
  return learntStudy(groups);
}

StudyReport CalibrateApp::detector() { return countedDetections(""); }

StudyReport CalibrateApp::gains() {
  StudyReport report =
      countedDetections(std::filesystem::absolute(config_file).lexically_normal().string());
  report.title = "What the sensors see, against the INI";
  report.remarks.push_back(
      "Objects without a label are those that the log's own tracks show (method.md 8.15): things, "
      "and without a truth all. What is never detected is in no track: P_D is too high by that.");
  return report;
}

/// `include`: the INI that gains.ini includes; then the log's own tracks take part.
StudyReport CalibrateApp::countedDetections(const std::string& include) {
  registerPerceptionClasses();
  Config config = loadConfig();
  const PipelineSetup setup = PipelineSetup::read(config);
  DetectorStudyInput input;
  input.classes = setup.model.classes;
  input.include = include;
  std::map<std::string, std::size_t> labels;
  for (const PipelineSetup::Sensor& sensor : setup.sensors) {
    if (!sensor.active) continue;
    input.labels[sensor.label] = sensor.front_end->labelNames();
    labels[sensor.label] = input.labels[sensor.label].size();
    input.stated[sensor.label] = sensor.params;
  }
  std::map<std::string, DetectorCounts> counts;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Config own = loadConfig();
    const RecordedLog recorded = recordLog(inputs[i], own, seconds);
    input.simulated = input.simulated || recorded.simulated;
    input.logs += (i ? ", " : "") + recorded.name;
    countDetections(recorded,
                    include.empty() ? truthBeside(inputs[i]) : labelsOf(recorded, inputs[i]), i,
                    labels, counts);
  }
  return detectorStudy(input, counts);
}

/// The truth beside the log, if there is one and it is wanted, with its own tracks.
GroundTruth CalibrateApp::labelsOf(const RecordedLog& log, const std::string& file) const {
  const TrackedRun run = replay(log, {log.model.proposal, log.particles.sample_size, seed});
  const bool hiding = std::any_of(log.entries.begin(), log.entries.end(),
                                  [](const auto& e) { return e.scan && e.scan->occlusion; });
  const int occluded = hiding ? 3 : 0;  // 3: not known
  const std::string truth = truthFileOf(file);
  return no_truth || !std::filesystem::exists(truth)
             ? tracksAsTruth(run, occluded)
             : withTracks(readGroundTruth(truth), run, occluded);
}

StudyReport CalibrateApp::lidarClasses() {
  registerPerceptionClasses();
  ClusterSamples samples;
  std::vector<TrainingLog> logs;
  Provenance provenance{"1", date, license, {}, true};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Config config = loadConfig();
    const PipelineSetup setup = PipelineSetup::read(config);
    config.finish();
    const auto sensor = std::find_if(setup.sensors.begin(), setup.sensors.end(), [](auto& s) {
      return s.active && dynamic_cast<const LidarFrontEnd*>(s.front_end.get()) != nullptr;
    });
    if (sensor == setup.sensors.end())
      throw DataError(config_file + ": no lidar is in use: check [run] sensors");
    const PointLabels labels(inputs[i]);
    const GroundTruth truth = labels.any() ? GroundTruth{} : truthBeside(inputs[i]);
    SampleRules rules;
    rules.variants = variants;
    rules.fov = radians(complete_fov[std::min(i, complete_fov.size() - 1)]);
    ClusterSampler sampler(sensor->label, dynamic_cast<const LidarFrontEnd&>(*sensor->front_end),
                           truth, labels, i, rules, seed, samples);
    const LogPass pass = passLog(inputs[i], forFrontEnds(setup), seconds, sampler);
    logs.push_back({std::filesystem::path(inputs[i]).stem().string(), pass.simulated});
    provenance.data.push_back(logs.back().name + (pass.simulated ? " (simulated)" : ""));
    provenance.simulated_only = provenance.simulated_only && pass.simulated;
  }
  return clusterStudy(samples, logs, provenance, seed, model_only);
}

std::unique_ptr<App> calibrateApp() { return std::make_unique<CalibrateApp>(); }

}  // namespace perception
