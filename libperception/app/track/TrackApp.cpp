#include "libperception/app/track/TrackApp.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <thread>
#include <utility>

#include "libperception/app/Programs.h"
#include "libperception/live/RosView.h"
#include "libperception/pipeline/LogRun.h"
#include "libperception/pipeline/input/LiveInput.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/pipeline/watches/StageWatchdog.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/ReadAhead.h"

namespace perception {
namespace fs = std::filesystem;

/// [s] The real-time factor of a shorter log says nothing.
constexpr double kShortLog = 1;
/// [s] A stage that takes as long hangs: the slowest takes a tenth of a second. Assumed.
constexpr double kLongestStage = 10;

namespace {

/// Tells the graph of each event; `ros` may be null.
EventLog::Listener listenerOf(RosView* ros) {
  if (ros == nullptr) return {};
  return
      [ros](std::optional<Stamp>, const nlohmann::ordered_json& content) { ros->onEvent(content); };
}

/// Nothing that hangs can be asked to end.
[[noreturn]] void endHungRun(const std::string& stage) {
  fmt::print(stderr, "perception-track: error: {} does not get on for {} s: the run ends\n",
             stage.empty() ? "something between stages" : "stage " + stage, kLongestStage);
  std::fflush(stderr);
  std::_Exit(static_cast<int>(ExitCode::kTryAgain));
}

}  // namespace

void TrackApp::declare(CLI::App& cli) {
  addConfigOptions(cli, false);
  addInputOption(cli, false);
  cli.get_option("--input")->description(
      "Rawlog, or several, each tracked by itself; live:INI, ros2:INI: the sensors of a running "
      "system");
  addOutputOption(cli, false);
  addRunOptions(cli);
  cli.add_option("--sensors", sensors,
                 "Sensors to use, joined by +, for example C+L: C camera, L lidar, R radar; C/H is "
                 "the camera with its headings as one wide Gaussian. Default: those of the INI");
  cli.add_option("--seed", seed, "Seed of all random numbers; default: that of the INI");
  cli.add_option(
         "--rate", rate,
         "[Hz] Write scenes at this fixed rate instead of at each scan of the output sensor")
      ->check(CLI::Range(0.0, 1000.0));
  cli.add_flag("--measurements", measurements,
               "Record the filter's input: measurements.csv, scans.csv, sensors.csv");
  cli.add_option(
         "--duration", duration,
         "[s] End a live run (-i live:INI, ros2:INI) after this time; default: on SIGINT or "
         "SIGTERM")
      ->check(CLI::Range(0.01, 1e9));
  cli.add_option("--record", record,
                 "Record the sensors of -i live:INI or ros2:INI in this folder");
  cli.add_option("--publish", publish,
                 "Publish scenes to ROS 2 nodes over DDS on INTERFACE[:DOMAIN], for example lo:0");
  declareServe(cli);
  cli.add_flag("--overwrite", overwrite,
               "Replace all results in the output folder, even those of another run, with their "
               "evaluation and film; without it a folder with other results is refused");
  cli.add_flag("--info", info,
               "List the sensor labels, classes and rates of the logs of -i and exit");
  cli.add_option(
         "--export", exports,
         "Also write the objects in another format: kitti:FILE writes KITTI's tracking format")
      ->allow_extra_args(false);
}

void TrackApp::declareServe(CLI::App& cli) {
  cli.add_option(
         "--serve", serve.port,
         "Serve a live view of the run to a browser or to Foxglove on this port (0: any free "
         "port); the program prints the address to open")
      ->expected(0, 1)
      ->default_str("8765");
  cli.add_option(
      "--serve-address", serve.address,
      "Address on which --serve listens; if other machines can reach it, --serve-token is needed");
  cli.add_option("--serve-token", serve.token_file,
                 "File with the access token; clients must add ?token=TOKEN to the address");
  cli.add_option("--serve-origin", serve.origins,
                 "Also let web pages of this origin connect, for example https://HOST")
      ->allow_extra_args(false);
  cli.add_option("--serve-speed", serve.speed,
                 "Play a log at this multiple of the recorded speed; default: as fast as possible")
      ->check(CLI::Range(0.01, 1000.0));
}

std::string TrackApp::exportFileFor(const std::string& log) const {
  if (exports.empty()) return "";
  if (exports.size() > 1) throw Error(ExitCode::kUsage, "--export: at most one");
  const std::string prefix = "kitti:";
  if (exports[0].rfind(prefix, 0) != 0 || exports[0].size() == prefix.size()) {
    throw Error(ExitCode::kUsage, "--export '" + exports[0] + "': expected kitti:FILE");
  }
  const fs::path file = exports[0].substr(prefix.size());
  if (inputs.size() == 1) return file.string();
  // Several logs: one file each, named by the log.
  return (file.parent_path() / (fs::path(log).stem().string() + "." + file.filename().string()))
      .string();
}

Config TrackApp::configWithOptions() const {
  Config config = loadConfig();
  // As settings of [run], so that they are in the effective INI.
  if (!sensors.empty()) config.set("run.sensors=" + sensors);
  if (seed) config.set(fmt::format("run.seed={}", *seed));
  if (measurements) config.set("run.write_measurements=true");
  if (rate > 0) config.set(fmt::format("run.output_rate={}", rate));
  return config;
}

void TrackApp::printContents(const std::string& log) {
  if (const auto ini = liveIniOf(log))
    throw Error(ExitCode::kUsage, isOfRosGraph(log) ? "perception-grabber --list -c " + log +
                                                          " says what a graph holds"
                                                    : log + ": --info is of logs");
  RawlogReader reader(log);
  LogContents contents;
  while (const auto observation = reader.next()) {
    stopIfAsked();
    contents.look(*observation);
  }
  fmt::print("{}\n{}", log, contents.table());
  if (reader.end() == RawlogReader::End::kClean) return;
  if (strict) throw DataError(reader.endMessage());
  warn(reader.endMessage());
}

void TrackApp::run() {
  registerPerceptionClasses();
  if (info && inputs.empty()) throw Error(ExitCode::kUsage, "--info needs -i/--input");
  if (info) {
    for (const auto& log : inputs) printContents(log);
    return;
  }
  if (config_file.empty()) throw Error(ExitCode::kUsage, "-c/--config is needed");
  Config config = configWithOptions();
  const PipelineSetup setup = PipelineSetup::read(config);
  if (configDone(config)) return;
  if (inputs.empty()) throw Error(ExitCode::kUsage, "-i/--input: at least one rawlog is needed");
  if (output.empty()) throw Error(ExitCode::kUsage, "-o/--output is needed");
  checkInputs();
  std::optional<tbb::global_control> limit;
  if (threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  std::map<std::string, std::string> log_of;
  for (const auto& log : inputs) {
    const std::string name = fs::path(log).stem().string();
    if (!log_of.emplace(name, log).second) {
      throw Error(ExitCode::kUsage, fmt::format("'{}' and '{}' would both write to {}/{}",
                                                log_of[name], log, output, name));
    }
  }
  for (const Shard& shard : shards(config.effectiveText())) trackLog(setup, shard);
}

void TrackApp::checkInputs() const {
  bool live = false;
  for (const auto& log : inputs) {
    exportFileFor(log);
    live = live || liveIniOf(log);
  }
  if (live && inputs.size() > 1)
    throw Error(ExitCode::kUsage, "-i live:INI or ros2:INI is the only input of a run");
  if (!live && (duration > 0 || !record.empty()))
    throw Error(ExitCode::kUsage, "--duration and --record belong to -i live:INI and ros2:INI");
  if (live && serve.speed > 0)
    throw Error(ExitCode::kUsage, "--serve-speed is of logs; sensors at work have their own");
  if (serve.port) serve.rules();
  if (live && !overwrite && fs::exists(output + "/done.json"))
    throw Error(ExitCode::kBadConfig,
                output + ": holds a run; give another folder, or --overwrite to remove it");
}

int TrackApp::threadCount() const {
  return threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
}

std::unique_ptr<ObservationInput> TrackApp::openInput(const std::string& log, FileSink sink) const {
  if (const auto ini = liveIniOf(log))
    return std::make_unique<LiveInput>(LiveInput::Params{*ini, duration, record});
  auto reader = std::make_unique<RawlogReader>(log, std::move(sink));
  if (threadCount() == 1) return reader;
  return std::make_unique<ReadAhead>(std::move(reader));
}

std::vector<TrackApp::Shard> TrackApp::shards(const std::string& effective_ini) {
  const std::string configuration = configurationHash(effective_ini, PERCEPTION_VERSION);
  std::vector<Shard> out;
  for (const auto& log : inputs) {
    const std::string dir =
        inputs.size() == 1 ? output : output + "/" + fs::path(log).stem().string();
    Shard shard{log, dir, exportFileFor(log), effective_ini, configuration, ""};
    // Whoever reads what is no file says what it is.
    if (!overwrite && fs::exists(dir + "/done.json") && fs::is_regular_file(log))
      shard.hash = hashOfRun(sha256OfFile(log), configuration);
    const bool exported = shard.export_file.empty() || fs::exists(shard.export_file);
    // All folders are looked at before the first log is tracked.
    if (!isFinished(dir, shard.hash, overwrite) || !exported) {
      out.push_back(std::move(shard));
    } else {
      fmt::print("{}: already done, results in {}\n", log, dir);
      // The same code as of the run itself.
      for (const auto& warning : readRunRecord(dir + "/done.json").warnings)
        warn(fmt::format("{}: already done, with a warning: {}", log, warning));
    }
  }
  return out;
}

void TrackApp::trackLog(const PipelineSetup& setup, const Shard& shard) {
  out_scenes.clear();
  out_record = {};
  FileHash log_hash;
  FileSink to_hash;
  if (shard.hash.empty())
    to_hash = [&](const unsigned char* bytes, std::size_t count) { log_hash.add(bytes, count); };
  std::optional<LiveView> view;
  if (serve.port) {
    view.emplace(serve, shard.log, config_file, setup.model.classes.names());
    fmt::print("{}: live at {}\n", shard.log, view->url());
    std::fflush(stdout);
  }
  LogRun run(setup, {shard.log, shard.dir, shard.export_file}, openInput(shard.log, to_hash));
  std::optional<StageWatchdog> watchdog;
  if (liveIniOf(shard.log)) watchdog.emplace(run.timing(), kLongestStage, endHungRun);
  std::unique_ptr<RosView> ros;
  if (!publish.empty())
    ros = std::make_unique<RosView>(rosTopicsFor(publish, shard.log, setup.model.classes.names()));
  if (view)
    view->watch(run, listenerOf(ros.get()));
  else if (ros)
    run.listen(listenerOf(ros.get()));
  else if (!liveIniOf(shard.log))
    run.letGridLag();
  run.read([&](const Scene& scene) {
    if (view) view->put(scene, run);
    if (ros) ros->put(scene, run);
    if (keep_scenes) out_scenes.push_back(scene);
  });
  watchdog.reset();  // writing the results may take a slow disk longer
  for (const std::string& message : run.finish(strict)) warn(message);
  if (view) fmt::print("{}: {}\n", shard.log, view->end());
  if (ros && ros->missed() > 0)
    warn(fmt::format("{}: readers on {} missed {} messages: they were too slow", shard.log, publish,
                     ros->missed()));
  run.record.program = name();
  run.record.version = PERCEPTION_VERSION;
  run.record.hash = shard.hash;
  if (shard.hash.empty() && !liveIniOf(shard.log))
    run.record.hash = hashOfRun(log_hash.finish(shard.log), shard.configuration_hash);
  run.record.config = config_file;
  out_real_time_factor = run.realTimeFactor();
  run.commit(shard.effective_ini, threadCount());
  out_record = run.record;
  const double length = out_record.last_stamp - out_record.first_stamp;
  const std::string factor =
      length < kShortLog ? "" : fmt::format(" ({:.1f} times real time)", out_real_time_factor);
  for (const SensorRecord& s : out_record.sensors) {
    say(1, fmt::format("{}: {} frames, {} measurements; left out: {} frames, {} measurements, {} "
                       "returns",
                       s.label, s.frames, s.measurements, s.dropped_frames, s.dropped_measurements,
                       s.dropped_points));
  }
  for (const auto& [kind, count] : out_record.events) say(1, fmt::format("{}: {}", kind, count));
  fmt::print("{}: {} scenes, {} objects, {:.1f} s of log in {:.1f} s{}, results in {}\n", shard.log,
             out_record.scenes, out_record.tracks, length, run.wallSeconds(), factor, shard.dir);
  if (const auto learned = run.learned(); !learned.empty())
    fmt::print("learned, for the INI:\n{}\n", fmt::join(learned, "\n"));
}

std::unique_ptr<App> trackApp() { return std::make_unique<TrackApp>(); }

}  // namespace perception
