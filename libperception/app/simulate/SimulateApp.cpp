#include "libperception/app/simulate/SimulateApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <future>
#include <system_error>

#include "gui-offscreen/drawing/Picture.h"
#include "libperception/app/Programs.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/ScenarioPictures.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunTiming.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/lidar/PointTruth.h"
#include "libperception/simulation/recorded/AlteredRecording.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {

namespace {

// FILE.lanes.csv beside FILE.rawlog.
std::string lanesFileOf(const std::string& rawlog) {
  std::filesystem::path path(rawlog);
  if (path.extension() == ".rawlog") path.replace_extension();
  return path.string() + ".lanes.csv";
}

}  // namespace

void SimulateApp::declare(CLI::App& cli) {
  addConfigOptions(cli, false);
  cli.add_option("--seed", seed, "Seed of all random numbers: same seed, same bytes")
      ->capture_default_str();
  cli.add_option("--trial", trial,
                 "Trial 1, 2, ... of the scenario ([variation]): paths and noise drawn from "
                 "the seed; 0 = the unchanged scenario")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  cli.add_option("--vehicle", vehicle,
                 "INI of a vehicle whose sensors replace those of the scenario")
      ->check(CLI::ExistingFile);
  cli.add_option("--weather", weather, "INI of weather that replaces [weather] of the scenario")
      ->check(CLI::ExistingFile);
  addOutputOption(cli, false);
  cli.add_option(
      "--coverage", coverage,
      "Picture (PNG) of the coverage of the sensors of -c (vehicle or scenario); no log");
  cli.add_option("--contact-sheet", contact_sheet, "Picture (PNG) of the scenarios named; no log");
  cli.add_option("SCENARIO", scenes, "Scenario INIs of the contact sheet")
      ->check(CLI::ExistingFile);
  cli.add_option("--threads", threads, "Number of threads; 0 = as many as the machine has")
      ->check(CLI::Range(0, 4096));
  cli.add_option("--gzip", gzip_level, "Gzip level of the log")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  declareRecording(cli);
}

std::optional<Scenario> SimulateApp::loadScenario() {
  Config config = loadConfig();
  Scenario scenario = readScenario(config);
  if (trial > scenario.variation.trials) {
    config.fault(
        "variation", "trials",
        fmt::format("there are {}, trial {} was asked for", scenario.variation.trials, trial));
  }
  if (configDone(config)) return {};
  if (!vehicle.empty()) {
    Config other = Config::fromFile(vehicle);
    if (other.has("ego")) scenario.ego.pose = other.read<PoseParams>("ego");
    scenario.sensors = readSensors(other);
    if (scenario.sensors.empty()) other.fault("", "", "no [sensor.LABEL] section");
    other.finish();
  }
  if (!weather.empty()) {
    Config other = Config::fromFile(weather);
    scenario.weather = other.read<SimulatedWeatherParams>("weather", {}, true);
    other.finish();
  }
  return trialOf(std::move(scenario), trial, seed);
}

void SimulateApp::writeLabels(std::int64_t frame, const std::vector<std::uint32_t>& labels) {
  const std::string folder = labelFolderOf(output);
  if (out_labels++ == 0) createFolder(folder);
  writeFile((std::filesystem::path(folder) / labelFileName(frame)).string(), labelBytes(labels));
}

void SimulateApp::drawCoverage() {
  Config config = loadConfig();
  // A vehicle INI has no scene; other sections of a scenario do not affect the picture.
  const bool is_scenario = config.has("scenario");
  std::vector<SensorParams> sensors;
  if (is_scenario) {
    sensors = readScenario(config).sensors;
  } else {
    config.read<PoseParams>("ego");
    sensors = readSensors(config);
    if (sensors.empty()) config.fault("", "", "no [sensor.LABEL] section");
  }
  if (configDone(config)) return;
  const std::string name =
      is_scenario ? config_file : std::filesystem::path(config_file).stem().string();
  writePicture(coverage, coveragePicture(sensors, "Coverage of the sensors: " + name));
}

void SimulateApp::drawContactSheet() {
  std::vector<NamedScenario> scenarios;
  for (const std::string& scene : scenes) {
    Config config = Config::fromFile(scene);
    scenarios.push_back({std::filesystem::path(scene).stem().string(), readScenario(config)});
    config.finish();
  }
  if (scenarios.empty()) throw Error(ExitCode::kUsage, "--contact-sheet: no scenario INI is named");
  writePicture(contact_sheet, scenarioSheet(scenarios));
}

void SimulateApp::run() {
  if (recording_->parsed()) return alterRecording();
  if (!contact_sheet.empty()) return drawContactSheet();
  if (config_file.empty()) throw Error(ExitCode::kUsage, "-c SCENARIO.ini is required");
  if (!coverage.empty()) return drawCoverage();
  if (output.empty() && !print_config) {
    throw Error(ExitCode::kUsage, "-o FILE.rawlog is required");
  }
  std::optional<Scenario> loaded = loadScenario();
  if (!loaded) return;
  Scenario scenario = std::move(*loaded);
  const RunTiming timing;
  const std::string scene = std::filesystem::path(config_file).stem().string();
  const std::string name = trial > 0 ? fmt::format("{}, trial {}", scene, trial) : scene;
  const double duration = scenario.params.duration;
  const std::vector<Lane> lanes = scenario.lanes;
  Simulator simulator(std::move(scenario), name, trialSeed(seed, trial), threads);
  RawlogWriter log(output, gzip_level);
  removeLabels(output);
  {
    Progress progress("simulate", static_cast<std::uint64_t>(duration * 1e3));
    // An observation is compressed while the next one is simulated.
    std::future<void> packed;
    while (const auto observation = simulator.next()) {
      stopIfAsked();
      if (const auto labels = simulator.takeLabels()) writeLabels(simulator.frames() - 1, *labels);
      if (packed.valid()) packed.get();
      packed = std::async(std::launch::async, [&log, observation] { log.write(*observation); });
      progress.update(static_cast<std::uint64_t>(simulator.time() * 1e3),
                      static_cast<std::uint64_t>(simulator.frames()));
    }
    if (packed.valid()) packed.get();
  }
  // The truth first, so that a log with its final name always has one.
  log.finish();
  out_truth_file = truthFileOf(output);
  writeGroundTruth(out_truth_file, simulator.truth());
  if (!lanes.empty()) writeFile(lanesFileOf(output), lanesText(lanes));
  log.close();
  out_frames = simulator.frames();
  out_entries = log.entries(), out_bytes = log.bytes();
  out_points = simulator.points(), out_boxes = simulator.boxes(), out_beams = simulator.beams();
  out_targets = simulator.targets();
  fmt::print("{}: simulated, scenario {}, seed {}: {} frames, {} entries, {:.2f} MB\n", output,
             name, seed, out_frames, out_entries, static_cast<double>(out_bytes) * 1e-6);
  fmt::print("  lidar: {} scans, {} points; camera: {} boxes; radar: {} targets\n",
             simulator.scans(), out_points, out_boxes, out_targets);
  if (simulator.images() > 0) fmt::print("  camera: {} rendered images\n", simulator.images());
  fmt::print("{}: {} rows\n", out_truth_file, simulator.truth().size());
  if (out_labels > 0) fmt::print("{}: labels of {} scans\n", labelFolderOf(output), out_labels);
  if (simulator.unwritten() > 0) {
    warn(fmt::format("{} frames omitted: there is no observation class for them",
                     simulator.unwritten()));
  }
  const double wall = timing.wallSeconds();
  say(1, fmt::format(
             "{:.2f} s for {:.1f} s of log: {:.2f} times real time, {:.2f} million beams a second",
             wall, duration, duration / wall, static_cast<double>(out_beams) * 1e-6 / wall));
}

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
}

void SimulateApp::alterRecording() {
  Config config = loadConfig();
  RecordingTask task{inputs.front(), output, {}, seed, threads};
  task.weather = config.read<SimulatedWeatherParams>("weather", {}, true);
  if (configDone(config)) return;
  std::error_code error;
  if (std::filesystem::equivalent(task.input, output, error))
    throw Error(ExitCode::kUsage, "-o: is the recording itself");
  registerPerceptionClasses();
  const RunTiming timing;
  std::optional<Progress> progress;
  const AlteredRecording done = alteredRecording(
      task,
      [this](std::int64_t frame, const std::vector<std::uint32_t>& labels) {
        writeLabels(frame, labels);
      },
      [&](std::uint64_t bytes, std::uint64_t scans) {
        stopIfAsked();
        if (!progress) progress.emplace("weather", std::filesystem::file_size(task.input));
        if (bytes > 0) progress->update(bytes, scans);
      });
  progress.reset();
  out_truth_file = done.truth_file;
  out_entries = done.entries, out_bytes = done.bytes;
  out_points = done.counts.returns, out_lost = done.counts.lost;
  out_phantoms = done.counts.phantoms;
  fmt::print("{}: {}, {} entries, {:.2f} MB\n{}", output, done.text, out_entries,
             static_cast<double>(out_bytes) * 1e-6, textOf(done.counts));
  if (out_labels > 0)
    fmt::print("  {}: what each return is, {} scans\n", labelFolderOf(output), out_labels);
  for (const std::string& warning : done.warnings) warn(warning);
  const double wall = timing.wallSeconds();
  say(1, fmt::format("{:.2f} s for {:.1f} s of log: {:.2f} times real time", wall, done.duration,
                     done.duration / wall));
}

std::unique_ptr<App> simulateApp() { return std::make_unique<SimulateApp>(); }

}  // namespace perception
