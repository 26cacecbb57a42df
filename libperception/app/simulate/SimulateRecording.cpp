// perception-simulate weather: simulated weather on a recording.
#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <set>

#include "libperception/app/simulate/SimulateApp.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/lidar/PointTruth.h"
#include "libperception/simulation/recorded/RecordedScene.h"
#include "libperception/simulation/recorded/WeatheredLog.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// What has to be known of a recording before its first scan.
struct Recording {
  std::optional<Stamp> first, last;
  std::vector<RecordedPose> poses;
  std::set<std::string> sensors, lidars;  // labels
};

Recording surveyOf(const std::string& file) {
  Recording found;
  EgoPose ego;
  RawlogReader log(file);
  while (const auto observation = log.next()) {
    stopIfAsked();
    const auto stamp = toStamp(observation->timestamp);
    if (!stamp) continue;
    if (!found.first) found.first = stamp;
    found.last = stamp;
    ego.add(*observation);
    if (!isSensorData(*observation)) continue;
    if (!isImage(*observation) && found.sensors.insert(observation->sensorLabel).second) {
      const auto frame = frameFromObservation(*observation);
      if (frame && std::holds_alternative<LidarCloud>(frame->data))
        found.lidars.insert(frame->sensor);
    }
    if (const auto state = ego.at(*stamp))
      found.poses.push_back({*stamp - *found.first, state->T_world_ego});
  }
  if (!found.first) throw DataError(file + ": no observation with a stamp");
  return found;
}

/// The log's first entry.
mrpt::obs::CObservationComment simulatedComment(Stamp stamp, const std::string& text) {
  mrpt::obs::CObservationComment comment;
  comment.timestamp = fromStamp(stamp);
  comment.sensorLabel = "SIMULATED";
  comment.text = kSimulatedText + text;
  return comment;
}

void printCounts(const WeatheredLog::Counts& n) {
  fmt::print("  lidar: {} scans, {} returns: {} lost, {} phantoms\n", n.scans, n.returns, n.lost,
             n.phantoms);
  if (n.targets > 0) fmt::print("  radar: {} targets, {} lost\n", n.targets, n.targets_lost);
  if (n.images > 0) fmt::print("  images: {}, {} left out\n", n.images, n.images_left_out);
  if (n.boxes > 0) fmt::print("  boxes: {}, {} lost\n", n.boxes, n.boxes_lost);
}

}  // namespace

void SimulateApp::declareRecording(CLI::App& cli) {
  recording_ = cli.add_subcommand("weather",
                                  "Simulated weather on a recording: lidar returns, "
                                  "radar targets, images, boxes of image detectors");
  recording_
      ->add_option("-i,--input", inputs,
                   "Rawlog, with its truth (LOG.truth.csv) beside it, if there is one")
      ->required()
      ->expected(1);
  recording_->add_option("-c,--config", config_file, "INI with [weather]")->required();
  recording_->add_option("--set", settings,
                         "Change one value of the configuration: section.key=value");
  recording_
      ->add_option("-o,--output", output, "Rawlog; truth and FILE_Labels/ are written beside it")
      ->required();
  recording_->add_option("--seed", seed, "Seed of all random numbers")->capture_default_str();
  recording_->add_option("--threads", threads, "Number of threads; 0 = as many as the machine has")
      ->check(CLI::Range(0, 4096));
  recording_->add_option("--gzip", gzip_level, "Gzip level of the log")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
}

void SimulateApp::sayWhatChanged(const WeatheredLog& weathered) {
  const WeatheredLog::Counts& n = weathered.counts();
  out_points = n.returns, out_lost = n.lost, out_phantoms = n.phantoms;
  fmt::print("{}: {}, {} entries, {:.2f} MB\n", output, weathered.text(), out_entries,
             static_cast<double>(out_bytes) * 1e-6);
  printCounts(n);
  if (out_labels > 0)
    fmt::print("  {}: what each return is, {} scans\n", labelFolderOf(output), out_labels);
  if (n.images_left_out > 0)
    warn(fmt::format("{} images left out: not found, or without a calibration", n.images_left_out));
}

void SimulateApp::alterRecording() {
  Config config = loadConfig();
  const auto conditions = config.read<SimulatedWeatherParams>("weather", {}, true);
  if (configDone(config)) return;
  const std::string& input = inputs.front();
  std::error_code error;
  if (fs::equivalent(input, output, error))
    throw Error(ExitCode::kUsage, "-o: is the recording itself");
  registerPerceptionClasses();
  const auto start = std::chrono::steady_clock::now();
  const Recording recording = surveyOf(input);
  const std::string truth_file = truthFileOf(input);
  const bool has_truth = fs::exists(truth_file);
  const GroundTruth truth = has_truth ? readGroundTruth(truth_file) : GroundTruth{};
  const double duration = *recording.last - *recording.first;
  Scenario scene = recordedScene(truth, recording.poses, duration);
  scene.weather = conditions;
  WeatheredLog weathered(std::move(scene), *recording.first, seed, threads, imagesBeside(input));

  RawlogReader log(input);
  RawlogWriter out(output, gzip_level);
  removeOldLabels();
  // Labels are by frame number.
  const bool labeled = recording.lidars.size() == 1;
  std::int64_t last_labeled = -1;
  out.write(simulatedComment(*recording.first, weathered.text()));
  {
    Progress progress("weather", log.fileBytes());
    while (const auto observation = log.next()) {
      stopIfAsked();
      if (const auto altered = weathered.apply(observation)) out.write(*altered);
      if (labeled && weathered.labels() && weathered.frame() > last_labeled) {
        last_labeled = weathered.frame();
        writeLabels(last_labeled, *weathered.labels());
      }
      progress.update(log.bytesRead(), weathered.counts().scans);
    }
  }
  if (log.end() != RawlogReader::End::kClean) warn(log.endMessage());
  out.finish();
  if (has_truth) {
    out_truth_file = truthFileOf(output);
    fs::copy_file(truth_file, out_truth_file, fs::copy_options::overwrite_existing, error);
    if (error) throw OutputError(out_truth_file + ": cannot write: " + error.message());
  }
  out.close();

  out_entries = out.entries(), out_bytes = out.bytes();
  sayWhatChanged(weathered);
  if (!has_truth && (conditions.water_film_mm > 0 || conditions.snow_cover > 0))
    warn(truth_file + ": not there, so that no object whirls up spray");
  if (recording.poses.empty()) warn(input + ": no poses: the vehicle is taken to stand");
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say(1, fmt::format("{:.2f} s for {:.1f} s of log: {:.2f} times real time", wall, duration,
                     duration / wall));
}

}  // namespace perception
