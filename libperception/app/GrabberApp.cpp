#include "libperception/app/GrabberApp.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "libperception/capture/Grabber.h"
#include "libperception/pipeline/Progress.h"

namespace perception {

std::string GrabberApp::description() const {
  return "Records the sensors of a capture INI into rawlogs, each whole; lists what was lost.";
}

void GrabberApp::declare(CLI::App& cli) {
  cli.add_option("-c,--config", config_file, "INI of rawlog-grabber, as ini/capture.ini")
      ->required();
  addOutputOption(cli, true);
  cli.add_option("--duration", duration, "[s]; without: until SIGINT or SIGTERM")
      ->check(CLI::Range(0.01, 1e9));
}

void GrabberApp::run() {
  Grabber grabber(config_file, output);
  const auto begin = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::map<std::string, SensorLedger> before;
  const auto showRates = [&] {
    if (isatty(STDOUT_FILENO) == 0) return;
    fmt::print("{:6.0f} s {:8.1f} MB", passed(), static_cast<double>(grabber.bytes()) * 1e-6);
    for (const auto& [label, ledger] : grabber.sensors())
      fmt::print("  {} {}/s", label, ledger.written - before[label].written);
    fmt::print("\n");
    before = grabber.sensors();
  };
  grabber.run([&] { return stopAsked() || (duration > 0 && passed() >= duration); }, showRates);
  fmt::print("{}: {} chunks, {:.2f} MB, {:.1f} s\n", output, grabber.chunks(),
             static_cast<double>(grabber.bytes()) * 1e-6, passed());
  for (const auto& [label, ledger] : grabber.sensors())
    fmt::print("  {}: {} observations, {} late\n", label, ledger.written, ledger.late);
  for (const std::string& warning : grabber.warnings()) warn(warning);
  if (duration > 0) stopIfAsked();
}

}  // namespace perception
