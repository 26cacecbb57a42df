#include "studies/paper/PaperRuns.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "libperception/core/math/Angle.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/world/Scenario.h"
#include "studies/resolution/SensorSetRun.h"

namespace perception {
namespace {

constexpr const char* kAllSensors = "C+L+R";

Config vehicle(const PaperSite& site, const std::string& sensors) {
  Config config = Config::fromFile(site.vehicleConfig());
  config.set("run.sensors=" + sensors);
  return config;
}

Scenario scenarioOf(const PaperSite& site, const PaperEncounter& encounter,
                    const std::string& sensors) {
  Config config =
      Config::fromFile(fmt::format("{}/scenarios/{}.ini", site.ini, encounter.scenario));
  Scenario scenario = readScenario(config);
  config.finish();
  Config weather =
      Config::fromFile(fmt::format("{}/weather/{}.ini", site.ini, encounter.weather.name));
  scenario.weather = weather.read<SimulatedWeatherParams>("weather", {}, true);
  weather.finish();
  Config tracker = vehicle(site, sensors);
  const PipelineSetup setup = PipelineSetup::read(tracker);
  tracker.finish();
  // A sensor that no run uses need not be simulated.
  auto& all = scenario.sensors;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const SensorParams& s) { return !sensorInUse(setup, s.label); }),
            all.end());
  if (site.seconds > 0) scenario.params.duration = std::min(scenario.params.duration, site.seconds);
  return scenario;
}

std::string nameOf(const std::string& letter) {
  return letter == "L" ? "Lidar" : letter == "C" ? "Camera" : "Radar";
}

void evaluateFrontEnds(const PaperSite& site, const SensorSetRun& run, const GroundTruth& truth,
                       PaperOutcome& outcome) {
  Config config = vehicle(site, kAllSensors);
  const PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  FrontEndOptions options;
  options.selection.min_points = 0;
  options.surroundings = true;
  for (const RecordedSensor& sensor : run.measurements.sensors) {
    const PipelineSetup::Sensor* used = sensorInUse(setup, sensor.label);
    if (!used) continue;
    const std::string name = nameOf(std::string(1, letterOf(used->params.modality)));
    FrontEndEvaluation e = evaluateFrontEnd(run.measurements, sensor.label, truth, options);
    const auto known = outcome.front_ends.find(name);
    if (known == outcome.front_ends.end()) {
      outcome.front_ends.emplace(name, std::move(e));
    } else {
      known->second += e;
    }
  }
}

}  // namespace

const std::vector<PaperWeather>& paperWeathers() {
  static const std::vector<PaperWeather> all = {{"sunny", "Sunny", "sunny"},
                                                {"night", "Night", "night"},
                                                {"wet_cloudy", "Cloudy & Wet", "wet"},
                                                {"snow_rain", "Snow & Rain", "snow"},
                                                {"rain_10", "Rainy", ""}};
  return all;
}

std::string particlesName(int particles) {
  return fmt::format("{} particle{}", particles, particles == 1 ? "" : "s");
}

PaperOutcome runPaperEncounter(const PaperSite& site, const PaperEncounter& encounter) {
  const std::string table = encounter.weather.table;
  std::vector<std::pair<std::string, std::unique_ptr<SensorSetRun>>> runs;
  const auto start = [&](const std::string& name, Config config) {
    runs.emplace_back(name, std::make_unique<SensorSetRun>(name, config));
  };
  if (table.empty()) {
    start("C", vehicle(site, "C"));
  } else {
    for (const char* set : kPaperSets) start(set, vehicle(site, set));
  }
  for (const int n : kPaperParticles) {
    if (table != "sunny") break;
    Config config = vehicle(site, kAllSensors);
    config.set(fmt::format("particle_filter.sampleSize={}", n));
    start(particlesName(n), std::move(config));
  }

  Scenario scenario = scenarioOf(site, encounter, table.empty() ? "C" : kAllSensors);
  const int trials = std::max(1, scenario.variation.trials);
  const int trial = 1 + (encounter.trial - 1) % trials;
  const std::uint64_t seed = site.seed + static_cast<std::uint64_t>((encounter.trial - 1) / trials);
  Simulator simulator(trialOf(std::move(scenario), trial, seed), encounter.scenario,
                      trialSeed(seed, trial), 1);
  while (const auto observation = simulator.next()) {
    stopIfAsked();
    for (auto& [name, run] : runs) run->add(*observation);
  }

  const GroundTruth truth = truthByInstant(simulator.truth());
  PaperOutcome outcome;
  outcome.of = encounter;
  for (auto& [name, run] : runs) {
    run->finish();
    if (name == kAllSensors || name == "C") evaluateFrontEnds(site, *run, truth, outcome);
    if (name == "C") continue;
    EvaluationOptions options;
    options.selection.min_points = 0;
    options.sensors = name == "C/H+R"                       ? "C+R"
                      : name.find('+') == std::string::npos ? kAllSensors
                                                            : name;
    outcome.runs.emplace(name, evaluate(run->tracks, truth, options));
  }
  return outcome;
}

}  // namespace perception
