#include "studies/resolution/ResolutionStudy.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "libperception/app/App.h"
#include "libperception/measurement/models/CameraResolution.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/world/Scenario.h"
#include "studies/resolution/ResolutionImages.h"
#include "studies/resolution/SensorSetRun.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Observation = std::shared_ptr<mrpt::obs::CObservation>;

constexpr double kLook = 3;  // [s] of a log in which all its sensors have had a frame

/// The site's sensors in use, for the tables and the selection of simulated sensors.
PipelineSetup siteOf(const ResolutionOptions& options) {
  Config config = Config::fromFile(options.site.file);
  for (const std::string& setting : options.site.settings) config.set(setting);
  config.set("run.sensors=C+L+R");
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  const auto camera =
      std::find_if(setup.sensors.begin(), setup.sensors.end(),
                   [&](const PipelineSetup::Sensor& s) { return s.label == options.site.camera; });
  if (camera == setup.sensors.end() || camera->params.kind != "boxes")
    throw ConfigError(
        fmt::format("{}: [sensor.{}] of kind boxes is missing: --camera LABEL names "
                    "the sensor that takes the boxes",
                    options.site.file, options.site.camera));
  return setup;
}

std::string lidarOf(const PipelineSetup& site) {
  for (const auto& s : site.sensors) {
    if (s.active && s.params.modality == Modality::kLidar) return s.label;
  }
  return "";
}

ResolutionData simulated(const ResolutionOptions& options) {
  const PipelineSetup site = siteOf(options);
  Config config = Config::fromFile(options.scenario);
  Scenario scenario = readScenario(config);
  config.finish();
  if (options.seconds > 0)
    scenario.params.duration = std::min(scenario.params.duration, options.seconds);
  std::vector<SensorParams> sensors;
  std::map<std::string, int> cameras;  // label -> resolution
  std::set<char> letters;
  for (const SensorParams& s : scenario.sensors) {
    if (s.kind == SensorKind::kSphericalCamera && cameras.empty()) {
      for (int r = 0; r < static_cast<int>(cameraResolutions().size()); ++r) {
        SensorParams copy = s;
        copy.panorama.setResolution(static_cast<SphericalCameraParams::Resolution>(r));
        copy.label += fmt::format("_{}", cameraResolutions()[static_cast<std::size_t>(r)].name);
        cameras[copy.label] = r;
        sensors.push_back(std::move(copy));
      }
    } else if (const auto* used = sensorInUse(site, s.label)) {
      letters.insert(letterOf(used->params.modality));
      sensors.push_back(s);
    }
  }
  if (cameras.empty())
    throw ConfigError(options.scenario + ": no [sensor.LABEL] of kind spherical_camera");
  scenario.sensors = std::move(sensors);
  const std::string name = fs::path(options.scenario).stem().string();
  const double duration = scenario.params.duration;
  Simulator simulator(std::move(scenario), name, options.seed, 0);
  ResolutionStreams streams(options.site, letters, {0, 1, 2, 3}, false);
  Progress progress("resolution", static_cast<std::uint64_t>(duration * 1e3));
  while (const Observation observation = simulator.next()) {
    stopIfAsked();
    const auto camera = cameras.find(observation->sensorLabel);
    if (camera != cameras.end()) observation->sensorLabel = options.site.camera;
    streams.give(*observation, camera != cameras.end() ? camera->second : -1);
    progress.update(static_cast<std::uint64_t>(simulator.time() * 1e3),
                    static_cast<std::uint64_t>(simulator.frames()));
  }
  ResolutionData data;
  data.source = fmt::format("simulated: {}, {:g} s, seed {}", name, duration, options.seed);
  data.camera = options.site.camera;
  data.lidar = lidarOf(site);
  data.runs = streams.finish();
  data.truth = truthByInstant(simulator.truth());
  data.remarks = {
      "The simulated camera's detector has the ranges, recall and false boxes of Radecki et al.: "
      "the first two tables show that filter and front end keep them, not that a detector has "
      "them."};
  return data;
}

/// Contents of a log, from its first seconds.
struct LogContent {
  std::set<char> letters;  ///< of sensors of the site
  std::vector<int> resolutions;
  bool images = false;  ///< else boxes of the camera's label
};

LogContent lookInto(const ResolutionOptions& options, const PipelineSetup& site,
                    ResolutionImages* images) {
  LogContent content;
  RawlogReader reader(options.log);
  std::optional<Stamp> first;
  while (const auto o = reader.next()) {
    const auto now = reader.lastStamp();
    if (!first) first = now;
    if (!content.resolutions.empty() && now && first && *now - *first > kLook) break;
    const auto* used = sensorInUse(site, o->sensorLabel);
    if (used && used->label != options.site.camera)
      content.letters.insert(letterOf(used->params.modality));
    if (!content.resolutions.empty()) continue;
    if (images && images->isOurs(*o)) {
      if (images->load(*o)) content.resolutions = images->resolutions(), content.images = true;
    } else if (!images && o->sensorLabel == options.site.camera) {
      const auto frame = frameFromObservation(*o);
      const auto* boxes = frame ? std::get_if<ObjectDetections>(&frame->data) : nullptr;
      if (!boxes || boxes->camera.fx <= 0) continue;
      int best = 0;
      for (int r = 1; r < static_cast<int>(cameraResolutions().size()); ++r) {
        const auto off = [&](int i) {
          return std::abs(std::log(cameraResolutions()[static_cast<std::size_t>(i)].width /
                                   (kTwoPi * boxes->camera.fx)));
        };
        if (off(r) < off(best)) best = r;
      }
      content.resolutions = {best};
    }
  }
  if (content.resolutions.empty())
    throw DataError(fmt::format(
        "{}: no image in it that can be read{}", options.log,
        images ? ""
               : ", no boxes labeled " + options.site.camera + "; --detector INI finds boxes"));
  return content;
}

ResolutionData recorded(const ResolutionOptions& options) {
  registerPerceptionClasses();
  const PipelineSetup site = siteOf(options);
  std::optional<ResolutionImages> images;
  if (!options.detector.empty()) images.emplace(options.log, options.images, options.detector);
  const LogContent content = lookInto(options, site, images ? &*images : nullptr);
  ResolutionStreams streams(options.site, content.letters, content.resolutions, content.images);
  RawlogReader reader(options.log);
  std::optional<Stamp> first;
  int shown = 0;
  Progress progress("resolution", reader.fileBytes());
  while (const auto o = reader.next()) {
    stopIfAsked();
    if (!first) first = reader.lastStamp();
    if (options.seconds > 0 && first && *reader.lastStamp() - *first > options.seconds) break;
    if (images && images->isOurs(*o)) {
      const auto image = images->load(*o);
      if (!image) continue;
      ++shown;
      for (const int r : content.resolutions)
        streams.give(*images->boxes(*image, r, options.site.camera), r);
    } else if (!images || o->sensorLabel != options.site.camera) {
      streams.give(*o, -1);
    }
    progress.update(reader.bytesRead(), static_cast<std::uint64_t>(shown));
  }
  ResolutionData data;
  data.source = "log " + fs::path(options.log).stem().string();
  data.camera = options.site.camera;
  data.lidar = content.letters.count(letterOf(Modality::kLidar)) ? lidarOf(site) : "";
  data.runs = streams.finish();
  const fs::path beside =
      fs::path(options.log).parent_path() / (fs::path(options.log).stem().string() + ".truth.csv");
  if (!options.truth.empty() || fs::exists(beside))
    data.truth = readGroundTruth(options.truth.empty() ? beside.string() : options.truth);
  if (images && images->missing() > 0)
    data.remarks.push_back(fmt::format("{} images could not be read.", images->missing()));
  for (const auto& [r, seconds] : images ? images->seconds() : std::map<int, double>{}) {
    fmt::print("detector at {}: {:.3f} s an image\n",
               cameraResolutions()[static_cast<std::size_t>(r)].name, seconds / shown);
  }
  return data;
}

}  // namespace

void declareResolution(CLI::App& cli, ResolutionOptions& o) {
  cli.add_option("-c,--config", o.site.file, "INI of the vehicle whose camera takes the boxes")
      ->required()
      ->check(CLI::ExistingFile);
  cli.add_option("--camera", o.site.camera, "Its [sensor.LABEL]")->capture_default_str();
  cli.add_option("--set", o.site.settings, "section.key=value: overrides that INI");
  auto* scenario = cli.add_option("--scenario", o.scenario, "Simulated: INI of the scenario")
                       ->check(CLI::ExistingFile);
  cli.add_option("--log", o.log, "A rawlog with panoramas, other images or boxes")
      ->excludes(scenario);
  cli.add_option("--detector", o.detector, "INI of perception-detect, for a log with images")
      ->check(CLI::ExistingFile);
  cli.add_option("--images", o.images, "sensorLabel of the log's images; without it all");
  cli.add_option("-t,--truth", o.truth, "Truth of the log; without it LOG.truth.csv");
  cli.add_option("--seconds", o.seconds, "Of scenario or log; 0 = all")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
}

StudyReport resolutionStudy(const ResolutionOptions& options) {
  if (options.scenario.empty() == options.log.empty())
    throw Error(ExitCode::kUsage, "one of --scenario INI and --log FILE is needed");
  return resolutionReport(options.log.empty() ? simulated(options) : recorded(options));
}

}  // namespace perception
