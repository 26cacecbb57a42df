#include "libperception/app/SimulateApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>

#include "libperception/core/GroundTruth.h"
#include "libperception/sensors/RawlogWriter.h"
#include "libperception/simulation/Scenario.h"
#include "libperception/simulation/Simulator.h"

namespace perception {

std::string truthFileOf(const std::string& rawlog) {
  const std::filesystem::path path(rawlog);
  const bool named = path.extension() == ".rawlog";
  return (named ? path.parent_path() / path.stem() : path).string() + ".truth.csv";
}

std::string SimulateApp::description() const {
  return "Simulates a scenario: writes a rawlog and the truth, FILE.truth.csv, beside it.";
}

void SimulateApp::declare(CLI::App& cli) {
  addConfigOptions(cli, true);
  cli.add_option("--seed", seed, "Seed of all random numbers: same seed, same bytes")
      ->capture_default_str();
  addOutputOption(cli, true);
  cli.add_option("--threads", threads, "Threads; 0 = as many as the machine has")
      ->check(CLI::Range(0, 4096));
  cli.add_option("--gzip", gzip_level, "Compression of the log")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
}

void SimulateApp::run() {
  Config config = loadConfig();
  Scenario scenario = readScenario(config);
  if (configDone(config)) return;
  const auto start = std::chrono::steady_clock::now();
  const std::string scene = std::filesystem::path(config_file).stem().string();
  const double duration = scenario.params.duration;
  Simulator simulator(std::move(scenario), scene, seed, threads);
  RawlogWriter log(output, gzip_level);
  {
    Progress progress("simulate", static_cast<std::uint64_t>(duration * 1e3));
    while (const auto observation = simulator.next()) {
      stopIfAsked();
      log.write(*observation);
      progress.update(static_cast<std::uint64_t>(simulator.time() * 1e3),
                      static_cast<std::uint64_t>(simulator.frames()));
    }
  }
  // The truth first: a log of the final name then never lacks it.
  out_truth_file = truthFileOf(output);
  writeGroundTruth(out_truth_file, simulator.truth());
  log.close();
  out_frames = simulator.frames();
  out_entries = log.entries(), out_bytes = log.bytes();
  out_points = simulator.points(), out_boxes = simulator.boxes(), out_beams = simulator.beams();
  fmt::print("{}: simulated, scenario {}, seed {}: {} frames, {} entries, {:.2f} MB\n", output,
             scene, seed, out_frames, out_entries, static_cast<double>(out_bytes) * 1e-6);
  fmt::print("  lidar: {} scans, {} points; camera: {} boxes\n", simulator.scans(), out_points,
             out_boxes);
  fmt::print("{}: {} rows\n", out_truth_file, simulator.truth().size());
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say(1, fmt::format(
             "{:.2f} s for {:.1f} s of log: {:.2f} times real time, {:.2f} million beams a second",
             wall, duration, duration / wall, static_cast<double>(out_beams) * 1e-6 / wall));
}

}  // namespace perception
