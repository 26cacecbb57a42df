#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <string>

#include "libperception/app/App.h"
#include "libperception/app/Programs.h"
#include "libperception/capture/Grabber.h"
#include "libperception/capture/drivers/Drivers.h"
#include "libperception/capture/ros/RosList.h"
#include "libperception/config/Config.h"
#include "libperception/interop/ros/RosGraphParams.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// perception-grabber: records the sensors of an INI of rawlog-grabber, every packet accounted for.
class GrabberApp : public App {
 public:
  GrabberApp()
      : App("perception-grabber",
            "Records the sensors of a capture INI into whole rawlogs and lists what was lost.") {}

  double duration = 0;  ///< --duration [s]; 0: until SIGINT or SIGTERM
  std::string stream;   ///< --stream: pipe or file for observations as they come
  std::string publish;  ///< --publish INTERFACE[:DOMAIN] of DDS
  bool plugin = false;  ///< --plugin: print the path of MRPT's plugin and stop
  bool list = false;    ///< --list: say what a ROS 2 graph has and stop

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void printGraph() const;
};

/// The plugin beside this program, as installed or as built; throws Error where there is none.
std::string pluginPath() {
  std::error_code ignored;
  const fs::path prefix = fs::read_symlink("/proc/self/exe", ignored).parent_path().parent_path();
  for (const char* folder : {PERCEPTION_PLUGIN_DIR, "lib"}) {
    const fs::path plugin = prefix / folder / "libperception_mrpt_plugin.so";
    if (fs::exists(plugin, ignored)) return plugin.string();
  }
  throw Error(ExitCode::kUnavailable,
              fmt::format("{}: no libperception_mrpt_plugin.so below it, in {} or lib",
                          prefix.string(), PERCEPTION_PLUGIN_DIR));
}

}  // namespace

void GrabberApp::declare(CLI::App& cli) {
  cli.add_option("-c,--config", config_file,
                 "INI of rawlog-grabber, as ini/capture.ini; or ros2:INI");
  addOutputOption(cli, false);
  cli.add_option("--duration", duration, "[s] End after this time; default: at SIGINT or SIGTERM")
      ->check(CLI::Range(0.01, 1e9));
  cli.add_flag("--list", list,
               "With -c ros2:INI: say what topics the graph has and how often their messages come, "
               "over 3 s or --duration, and stop");
  cli.add_option(
      "--stream", stream,
      "Pipe or file that gets the observations as they come, for perception-track; -o is "
      "optional then");
  cli.add_option("--publish", publish,
                 "INTERFACE[:DOMAIN], as lo:0: send observations by DDS to CDdsSensor in other "
                 "processes and computers, and clouds to ROS 2 as well");
  cli.add_flag(
      "--plugin", plugin,
      "Print the path of the plugin for MRPT's own tools (rawlog-edit -p, RawLogViewer -l, "
      "rawlog-grabber -p) and stop");
}

void GrabberApp::printGraph() const {
  constexpr double kUsual = 3;  // [s]
  const auto ini = rosIniOf(config_file);
  if (!ini) throw Error(ExitCode::kUsage, "--list needs -c ros2:INI");
  Config config = ini->empty() ? Config::fromText("", "(no INI)") : Config::fromFile(*ini);
  const auto network = NetworkName::parse(config.read<RosGraphParams>("ros").network);
  fmt::print("{}", listOfGraph(network, duration > 0 ? duration : kUsual, stopAsked));
}

void GrabberApp::run() {
  if (plugin) return fmt::print("{}\n", pluginPath());
  if (config_file.empty()) throw Error(ExitCode::kUsage, "-c/--config is needed");
  if (list) return printGraph();
  if (output.empty() && stream.empty() && publish.empty())
    throw Error(ExitCode::kUsage, "-o/--output, --stream or --publish is needed");
  GrabberOutputs outputs{output, stream, {}};
  if (!publish.empty()) outputs.network = NetworkName::parse(publish);
  Grabber grabber(config_file, outputs);
  const auto begin = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::map<std::string, SensorLedger> before;
  const auto showRates = [&] {
    if (isatty(STDOUT_FILENO) == 0) return;
    fmt::print("{:6.0f} s {:8.1f} MB", passed(), static_cast<double>(grabber.bytes()) * 1e-6);
    for (const auto& [label, ledger] : grabber.sensors())
      fmt::print("  {} {}/s", label,
                 static_cast<std::int64_t>(ledger.written) -
                     static_cast<std::int64_t>(before[label].written));
    fmt::print("\n");
    before = grabber.sensors();
  };
  grabber.run([&] { return stopAsked() || (duration > 0 && passed() >= duration); }, showRates);
  if (!output.empty())
    fmt::print("{}: {} chunks, {:.2f} MB, {:.1f} s\n", output, grabber.chunks(),
               static_cast<double>(grabber.bytes()) * 1e-6, passed());
  for (const auto& [label, ledger] : grabber.sensors())
    fmt::print("  {}: {} observations, {} late\n", label, ledger.written, ledger.late);
  for (const std::string& note : grabber.notes()) fmt::print("  {}\n", note);
  for (const std::string& warning : grabber.warnings()) warn(warning);
  if (duration > 0) stopIfAsked();
}

std::unique_ptr<App> grabberApp() { return std::make_unique<GrabberApp>(); }

}  // namespace perception
