#include "studies/obstacles/ObstaclesStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "libperception/pipeline/output/Progress.h"
#include "studies/obstacles/ObstacleRun.h"
#include "studies/obstacles/ObstaclesReport.h"

namespace perception {
namespace {

constexpr double kFrontOfVehicle = 2.5;            // [m] for the length of a drive alone
constexpr std::uint32_t kDrivePurpose = 0x0B57AC;  // of random numbers

SimulatedWeatherParams weatherNamed(const std::string& name, const std::string& config_file) {
  if (name == "clear") return {};
  const auto folder = std::filesystem::path(config_file).parent_path() / "weather";
  Config config = Config::fromFile((folder / (name + ".ini")).string());
  auto weather = config.read<SimulatedWeatherParams>("weather", {}, true);
  config.finish();
  return weather;
}

bool isWanted(const ObstacleShape& shape, const std::vector<std::string>& parts) {
  if (parts.empty()) return true;
  for (const std::string& part : parts)
    if (shape.kind == part || shape.name.find(part) != std::string::npos) return true;
  return false;
}

std::vector<const ObstacleShape*> chosenShapes(const ObstaclesOptions& options) {
  std::vector<const ObstacleShape*> all, chosen;
  for (const ObstacleShape& shape : obstacleShapes())
    if (isWanted(shape, options.shapes)) all.push_back(&shape);
  if (all.empty()) throw Error(ExitCode::kUsage, "--shapes: no shape has such a name or kind");
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(options.stride))
    chosen.push_back(all[i]);
  return chosen;
}

DriveWay wayNamed(const std::string& name) {
  const auto& names = driveWayNames();
  return static_cast<DriveWay>(std::find(names.begin(), names.end(), name) - names.begin());
}

// The same noise in every weather and selection of drives.
std::uint64_t seedOf(const ObstacleDriveParams& p, unsigned long long seed) {
  const auto shape = static_cast<std::uint64_t>(p.shape - obstacleShapes().data());
  const auto speed = static_cast<std::uint32_t>(std::lround(10 * p.speed));
  Rng rng({seed, 1000 * shape + static_cast<std::uint64_t>(p.beams),
           4 * speed + static_cast<std::uint32_t>(p.way), kDrivePurpose});
  return rng();
}

std::vector<DriveCase> allCases(const ObstaclesOptions& options, const PipelineSetup& setup,
                                unsigned long long seed) {
  std::vector<DriveCase> cases;
  for (const std::string& name : options.weather) {
    DriveCase one;
    one.weather = name;
    one.params.weather = weatherNamed(name, options.config);
    one.params.lidar = lidarInUse(setup);
    one.params.sector = options.sector;
    for (const int beams : options.beams)
      for (const double speed : options.speeds)
        for (const std::string& way : options.ways)
          for (const ObstacleShape* shape : chosenShapes(options)) {
            one.params.shape = shape;
            one.params.beams = beams, one.params.speed = speed, one.params.way = wayNamed(way);
            one.params.distance =
                kFrontOfVehicle + stoppingDistance(speed, 0, setup.stop) + options.lead * speed;
            one.params.seed = seedOf(one.params, seed);
            cases.push_back(one);
          }
  }
  return cases;
}

void runCase(DriveCase& one, const ObstaclesOptions& options, const PipelineSetup& setup) {
  stopIfAsked();
  ObstacleDrive drive(one.params);
  for (const std::string& intensity : options.intensity)
    one.verdicts.push_back(runDrive(drive, one.params, setup, intensity == "given"));
}

}  // namespace

void declareObstacles(CLI::App& cli, ObstaclesOptions& o) {
  cli.add_option("-c,--config", o.config, "INI of the vehicle")
      ->capture_default_str()
      ->check(CLI::ExistingFile);
  cli.add_option("--set", o.settings, "section.key=value: overrides the INI");
  cli.add_option("--beams", o.beams, "Lidars by their beams")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::IsMember({16, 32, 64, 128}));
  cli.add_option("--speeds", o.speeds, "[m/s]")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1.0, 36.0));
  cli.add_option("--weather", o.weather, "clear, or INIs in weather/ beside the configuration")
      ->delimiter(',')
      ->capture_default_str();
  cli.add_option("--intensity", o.intensity, "Whether the lidar gives any")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::IsMember({"given", "none"}));
  cli.add_option("--ways", o.ways, "How the vehicle drives")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::IsMember(driveWayNames()));
  cli.add_option("--shapes", o.shapes, "Kinds, or parts of names; all where there are none")
      ->delimiter(',');
  cli.add_option("--stride", o.stride, "Every n-th of the shapes")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
}

StudyReport obstaclesStudy(const ObstaclesOptions& options, unsigned long long seed) {
  const PipelineSetup setup = [&] {
    std::vector<std::string> settings = options.settings;
    settings.push_back(fmt::format("run.seed={}", seed));
    PipelineSetup read = PipelineSetup::fromFile(options.config, settings);
    read.run.output_lag = read.model.history = 0;  // a stop cannot wait
    return read;
  }();
  std::vector<DriveCase> cases = allCases(options, setup, seed);
  tbb::parallel_for(std::size_t{0}, cases.size(),
                    [&](std::size_t i) { runCase(cases[i], options, setup); });
  return obstaclesReport(cases, options, chosenShapes(options).size());
}

}  // namespace perception
