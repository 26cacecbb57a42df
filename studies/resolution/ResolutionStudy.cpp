#include "studies/resolution/ResolutionStudy.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/measurement/models/CameraResolution.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/world/Scenario.h"
#include "studies/resolution/SensorSetRun.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Observation = std::shared_ptr<mrpt::obs::CObservation>;

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
  ResolutionStreams streams(options.site, letters, {0, 1, 2, 3});
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

}  // namespace

void declareResolution(CLI::App& cli, ResolutionOptions& o) {
  cli.add_option("-c,--config", o.site.file, "INI of the vehicle whose camera takes the boxes")
      ->required()
      ->check(CLI::ExistingFile);
  cli.add_option("--camera", o.site.camera, "Its [sensor.LABEL]")->capture_default_str();
  cli.add_option("--set", o.site.settings, "section.key=value: overrides that INI");
  cli.add_option("--scenario", o.scenario, "INI of the scenario")
      ->required()
      ->check(CLI::ExistingFile);
  cli.add_option("--seconds", o.seconds, "Of the scenario; 0 = all")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
}

StudyReport resolutionStudy(const ResolutionOptions& options) {
  return resolutionReport(simulated(options));
}

}  // namespace perception
