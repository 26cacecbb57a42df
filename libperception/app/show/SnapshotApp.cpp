#include "libperception/app/show/SnapshotApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "libperception/app/Programs.h"
#include "libperception/core/system/PathPattern.h"
#include "libperception/pictures/RunScenes.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {

namespace fs = std::filesystem;

void SnapshotApp::declare(CLI::App& cli) {
  cli.add_option(
         "-r,--run", run_dirs,
         "folder of a run of perception-track; a second one of the same log is drawn beside it")
      ->required()
      ->type_name("DIR")
      ->allow_extra_args(false);
  addInputOption(cli, false);
  cli.get_option("--input")->expected(1);
  addConfigOptions(cli, false);
  cli.add_option("-t,--truth", truth_file, "truth of the log, FILE.truth.csv")->type_name("FILE");
  auto* when = cli.add_option_group("when", "which instants");
  when->add_option("--time", time, "the scene nearest to this time of the log [s]");
  when->add_option("--frame", frame, "the scene of this frame of the log");
  when->add_option("--every", options.every, "interval of pictures, and a contact sheet [s]")
      ->check(CLI::Range(1e-3, 1e6));
  when->add_option("--contact", options.contact,
                   "one contact sheet of this many instants, equally spaced")
      ->check(CLI::Range(1, 100));
  when->add_option("--video", video, "a video of all scenes at the log's rate (needs ffmpeg)")
      ->type_name("FILE.mp4");
  when->require_option(1);
  cli.add_option("--from", video_from, "start of the video, time of the log [s]");
  cli.add_option("--to", video_to, "end of the video [s]");
  cli.add_option("-o,--output", output, "PNG or JPEG file; with --every a folder");
  cli.add_option("--scene", options.scene_file,
                 "with --time or --frame: also a file for MRPT's SceneViewer3D")
      ->type_name("FILE.3Dscene");
  cli.add_option("--grid", options.grid_files,
                 "with --time or --frame: also the safety grid, by the file's ending: .ot, .bt "
                 "(octovis), .gridmap.gz (MRPT), .png (from above)")
      ->type_name("FILE")
      ->allow_extra_args(false);
  cli.add_option(
      "--view", view,
      "top (from above), driver (from behind the vehicle), camera (its image), joined by "
      "+; both = top+driver; all = both, and the camera where the log has one; default: "
      "both, and the camera where the log has images");
  cli.add_option("--camera", sensors.camera, "label of the camera that is shown")
      ->type_name("LABEL");
  cli.add_flag("--details", options.details,
               "also draw the measurements, and the ids of things that are no road users");
  cli.add_option("--range", options.params.range, "range shown ahead [m]")
      ->check(CLI::Range(5.0, 200.0))
      ->capture_default_str();
  cli.add_option("--memory", sensors.memory,
                 "the grid has the lidar scans of this time before an instant [s]")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  cli.add_option("--title", titles, "title in place of the names of log and run, one per run")
      ->allow_extra_args(false);
}

// The site INI of -c, else the run's effective.ini, so that returns and measurements are those of
// the tracker.
Config SnapshotApp::readSite(const std::string& run_dir) {
  const std::string given = config_file;
  const std::string own = (fs::path(run_dir) / "effective.ini").string();
  if (given.empty() && fs::exists(own)) config_file = own;
  Config config = loadConfig();
  sensors.read(config, !config_file.empty());
  config_file = given;
  return config;
}

bool SnapshotApp::readConfig() { return configDone(readSite(run_dirs[0])); }

std::vector<std::size_t> SnapshotApp::chooseScenes(const TrackedRun& run) const {
  if (time) return {sceneAt(run, *time)};
  if (frame) return {sceneOfFrame(run, *frame)};
  if (!video.empty()) return scenesBetween(run, video_from, video_to);
  const std::vector<std::size_t> chosen = scenesEvery(run, options.every);
  return options.every > 0 ? chosen : spread(chosen, static_cast<std::size_t>(options.contact));
}

// Log and run; marks simulated logs.
std::string SnapshotApp::titleOf(std::size_t index) {
  if (index < titles.size()) return titles[index];
  const std::string& dir = run_dirs[index];
  const std::string run = lastFolderOf(dir);
  const fs::path record_file = fs::path(dir) / "done.json";
  if (!fs::exists(record_file)) {
    warn(fmt::format("{}: no done.json: the run did not finish", dir));
    return run + " (unfinished)";
  }
  const RunRecord record = readRunRecord(record_file.string());
  const std::string log = fs::path(record.input).filename().string();
  return fmt::format("{}{}, run {}", log, record.simulated ? " (simulated)" : "", run);
}

void SnapshotApp::readRuns() {
  shown_.clear();
  for (std::size_t i = 0; i < run_dirs.size(); ++i) {
    ShownRun shown{readTrackedRun(run_dirs[i]), titleOf(i), nullptr};
    if (shown.run.scenes.empty()) throw DataError(run_dirs[i] + ": the run holds no scene");
    shown_.push_back(std::move(shown));
  }
  if (inputs.empty()) return;
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    ShownRun& shown = shown_[i];
    if (i > 0) readSite(run_dirs[i]).finish();
    shown.sensors = std::make_unique<SnapshotSensors>(inputs[0], shown.run, sensors);
  }
}

void SnapshotApp::run() {
  out_files.clear();
  if (readConfig()) return;
  sensors.measurements = options.details;
  if (inputs.size() > 1) throw Error(ExitCode::kUsage, "-i: one log, that of the runs");
  if (output.empty() && video.empty())
    throw Error(ExitCode::kUsage, "-o: expected a file or folder");
  if (options.every <= 0 && !output.empty()) requirePictureName(output);
  if ((!options.scene_file.empty() || !options.grid_files.empty()) && !time && !frame) {
    throw Error(ExitCode::kUsage, "--scene, --grid: of one instant, --time or --frame");
  }
  if (!options.grid_files.empty() && inputs.empty()) {
    throw Error(ExitCode::kUsage, "--grid: the safety grid comes from the log's scans: -i");
  }
  if (options.contact > 0 && run_dirs.size() > 1)
    throw Error(ExitCode::kUsage, "--contact: of one run");
  options.params.views = viewsNamed(view.empty() ? "both" : view);
  registerPerceptionClasses();
  readRuns();
  if (view.empty() && shown_[0].sensors && shown_[0].sensors->hasImages())
    options.params.views.push_back(ViewKind::kCamera);
  const std::string mark = markOfRuns(run_dirs);
  const auto camera =
      std::find(options.params.views.begin(), options.params.views.end(), ViewKind::kCamera);
  if (camera != options.params.views.end() &&
      (!shown_[0].sensors || !shown_[0].sensors->layers().camera)) {
    // "all" shows the views available; a camera requested explicitly must exist.
    if (view != "all") {
      throw Error(
          ExitCode::kUsage,
          fmt::format("--view {}: {}", view,
                      inputs.empty() ? "images come from the log: -i"
                                     : inputs[0] + " holds no camera" +
                                           (sensors.camera.empty() ? "" : " of that label")));
    }
    options.params.views.erase(camera);
  }
  truth_.reset();
  if (!truth_file.empty()) truth_ = readGroundTruth(truth_file);
  const std::vector<std::size_t> chosen = chooseScenes(shown_[0].run);
  SnapshotWriter writer(shown_, truth_ ? &*truth_ : nullptr, options, mark);
  writer.on_file = [this](const std::string& text, const std::string& path) {
    out_files.push_back(path);
    fmt::print("{}\n", text);
  };
  writer.on_note = [this](const std::string& text) { say(1, text); };
  if (video.empty()) {
    writer.drawPictures(chosen, output);
  } else {
    writer.drawVideo(chosen, video);
  }
  out_picture = writer.last();
  reportLog();
}

void SnapshotApp::reportLog() {
  const SnapshotSensors* log = shown_[0].sensors.get();
  if (!log) return;
  const auto end = log->reader().end();
  if (end != RawlogReader::End::kNotYet && end != RawlogReader::End::kClean) {
    warn(log->reader().endMessage());
  }
  if (!log->missingImage().empty()) {
    warn(log->missingImage() + ": an image of the log cannot be loaded");
  }
  if (log->frames() == 0) {
    warn(fmt::format("{}: no sensor data at the run's times", inputs[0]));
  }
}

std::unique_ptr<App> snapshotApp() { return std::make_unique<SnapshotApp>(); }

}  // namespace perception
