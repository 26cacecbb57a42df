#include "libperception/calibration/CalibrationTasks.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "libperception/boxes3d/PositionFrontEnd.h"
#include "libperception/calibration/TemperingStudy.h"
#include "libperception/calibration/TracksAsTruth.h"
#include "libperception/calibration/clusters/ClusterStudy.h"
#include "libperception/calibration/detectors/BoxEvidenceStudy.h"
#include "libperception/calibration/detectors/ConfidenceStudy.h"
#include "libperception/calibration/detectors/DetectorStudy.h"
#include "libperception/calibration/detectors/LearntStudy.h"
#include "libperception/core/Error.h"
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

/// Boxes in space of the inputs, judged by their truth.
struct JudgedLogs {
  std::string sensor;
  std::map<std::string, std::string> names;  ///< the detector's class = label of the INI
  std::vector<BoxLog> logs;
};

/// `learning`: rated on the way by confidence = learnt, each log from nothing.
JudgedLogs judgedBoxes(const CalibrationInput& input, bool learning = false) {
  registerPerceptionClasses();
  JudgedLogs judged;
  for (const std::string& file : input.logs) {
    std::map<Stamp, ObjectDetections> seen;
    Config config = input.config();
    const RecordedLog log =
        recordLog(file, config, input.seconds, [&](mrpt::obs::CObservation& observation) {
          const auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation);
          const auto stamp = toStamp(observation.timestamp);
          if (!boxes || !hasSpaceBoxes(boxes->detections) || !stamp) return;
          judged.sensor = observation.sensorLabel;
          seen[*stamp] = boxes->detections;
        });
    std::optional<ConfidenceLearner> learner;
    if (learning) learner = learnerOf(judged.sensor, input.config());
    judged.logs.push_back(
        boxLog(log, judged.sensor, seen, truthBeside(file), learner ? &*learner : nullptr));
  }
  for (const std::string& name :
       input.config().read<PositionParams>("sensor." + judged.sensor + ".positions").names) {
    const auto equals = name.find('=');
    judged.names[name.substr(0, equals)] = name.substr(equals + 1);
  }
  return judged;
}

/// The truth beside the log, if there is one and it is wanted, with its own tracks.
GroundTruth labelsOf(const RecordedLog& log, const std::string& file, std::uint64_t seed,
                     bool without_truth) {
  const TrackedRun run = replay(log, {log.model.proposal, log.particles.sample_size, seed});
  const bool hiding = std::any_of(log.entries.begin(), log.entries.end(),
                                  [](const auto& e) { return e.scan && e.scan->occlusion; });
  const int occluded = hiding ? 3 : 0;  // 3: not known
  const std::string truth = truthFileOf(file);
  return without_truth || !std::filesystem::exists(truth)
             ? tracksAsTruth(run, occluded)
             : withTracks(readGroundTruth(truth), run, occluded);
}

/// `include`: the INI that gains.ini includes; then the log's own tracks take part.
StudyReport countedDetections(const CalibrationInput& from, const std::string& include,
                              bool without_truth) {
  registerPerceptionClasses();
  Config config = from.config();
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
  for (std::size_t i = 0; i < from.logs.size(); ++i) {
    Config own = from.config();
    const RecordedLog recorded = recordLog(from.logs[i], own, from.seconds);
    input.simulated = input.simulated || recorded.simulated;
    input.logs += (i ? ", " : "") + recorded.name;
    countDetections(recorded,
                    include.empty() ? truthBeside(from.logs[i])
                                    : labelsOf(recorded, from.logs[i], from.seed, without_truth),
                    i, labels, counts);
  }
  return detectorStudy(input, counts);
}

}  // namespace

StudyReport calibrateTempering(const CalibrationInput& input, int rounds, double range,
                               double fov) {
  TemperingParams params;
  params.seed = input.seed;
  if (rounds > 0) params.rounds = rounds;
  params.evaluation.selection.min_points = 5;  // poles are thin
  params.evaluation.selection.range = range;
  params.evaluation.selection.fov = fov;
  std::vector<TemperingLog> logs;
  for (const std::string& file : input.logs) {
    Config config = input.config();
    logs.push_back({recordLog(file, config, input.seconds), truthBeside(file)});
    params.particles = logs.back().log.particles.sample_size;
  }
  return temperingStudy(params, logs);
}

StudyReport calibrateBoxes(const CalibrationInput& input) {
  const JudgedLogs judged = judgedBoxes(input);
  return boxEvidenceStudy(judged.sensor, judged.logs, judged.names);
}

StudyReport calibrateConfidence(const CalibrationInput& input) {
  JudgedLogs judged = judgedBoxes(input);
  const auto view = input.config().read<DetectionParams>("sensor." + judged.sensor);
  ConfidenceInput study;
  study.sensor = judged.sensor;
  study.names = std::move(judged.names);
  study.clutter_per_scan = view.clutter_per_scan;
  study.logs = std::move(judged.logs);
  for (const std::string& file : input.logs) study.truths.push_back(truthBeside(file));
  study.evaluation.selection.min_points = 0;  // logs of boxes have no returns
  study.evaluation.selection.range = view.range_max;
  study.evaluation.selection.fov = study.evaluation.selection.complete_fov = view.fov;
  study.evaluation.exclusion = study.evaluation.tolerance;
  study.track = [&](std::size_t log, const ScoreKeys& keys) {
    Config config = input.config();
    const std::string section = "sensor." + study.sensor + ".positions.";
    config.set(section + "confidence=fitted");
    for (const auto& [key, value] : keys) config.set(section + key + "=" + value);
    RecordedLog recorded = recordLog(input.logs[log], config, input.seconds);
    recorded.scene.min_existence = leastExistence();
    return replay(recorded, {recorded.model.proposal, recorded.particles.sample_size, input.seed});
  };
  return confidenceStudy(study, std::filesystem::absolute(input.config_file).string());
}

StudyReport calibrateLearnt(const CalibrationInput& input) {
  JudgedLogs judged = judgedBoxes(input, true);
  std::vector<LearntGroup> groups;
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    const std::string folder =
        std::filesystem::absolute(input.logs[i]).parent_path().filename().string();
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const LearntGroup& g) { return g.name == folder; });
    if (group == groups.end()) group = groups.insert(group, {folder, {}});
    group->logs.push_back(std::move(judged.logs[i]));
  }
  return learntStudy(groups);
}

StudyReport calibrateDetector(const CalibrationInput& input) {
  return countedDetections(input, "", false);
}

StudyReport calibrateGains(const CalibrationInput& input, bool without_truth) {
  StudyReport report = countedDetections(
      input, std::filesystem::absolute(input.config_file).lexically_normal().string(),
      without_truth);
  report.title = "What the sensors see, against the INI";
  report.remarks.push_back(
      "Objects without a label are those that the log's own tracks show (method.md 8.15): things, "
      "and without a truth all. What is never detected is in no track: P_D is too high by that.");
  return report;
}

StudyReport calibrateLidarClasses(const CalibrationInput& input,
                                  const LidarClassesOptions& options) {
  registerPerceptionClasses();
  ClusterSamples samples;
  std::vector<TrainingLog> logs;
  Provenance provenance{"1", options.date, options.license, {}, true};
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    Config config = input.config();
    const PipelineSetup setup = PipelineSetup::read(config);
    config.finish();
    const auto sensor = std::find_if(setup.sensors.begin(), setup.sensors.end(), [](auto& s) {
      return s.active && dynamic_cast<const LidarFrontEnd*>(s.front_end.get()) != nullptr;
    });
    if (sensor == setup.sensors.end())
      throw DataError(input.config_file + ": no lidar is in use: check [run] sensors");
    const PointLabels labels(input.logs[i]);
    const GroundTruth truth = labels.any() ? GroundTruth{} : truthBeside(input.logs[i]);
    SampleRules rules;
    rules.fov = radians(options.complete_fov[std::min(i, options.complete_fov.size() - 1)]);
    ClusterSampler sampler(sensor->label, dynamic_cast<const LidarFrontEnd&>(*sensor->front_end),
                           truth, labels, i, rules, samples);
    const LogPass pass = passLog(input.logs[i], forFrontEnds(setup), input.seconds, sampler);
    logs.push_back({std::filesystem::path(input.logs[i]).stem().string(), pass.simulated});
    provenance.data.push_back(logs.back().name + (pass.simulated ? " (simulated)" : ""));
    provenance.simulated_only = provenance.simulated_only && pass.simulated;
  }
  if (!options.keep.empty())
    return knownShapesStudy(samples, logs, ClusterClassifier::read(options.keep));
  return clusterStudy(samples, logs, provenance, input.seed, options.model_only);
}

}  // namespace perception
