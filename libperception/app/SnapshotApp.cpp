#include "libperception/app/SnapshotApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "gui-offscreen/ContactSheet.h"
#include "libperception/app/Pipeline.h"
#include "libperception/app/SnapshotLidar.h"
#include "libperception/scene/RunRecord.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr double kTrail = 2;             // [s]
constexpr double kNearestScene = 0.51;   // [s] from --time: half the period of a scene a second
constexpr double kNearestTruth = 0.06;   // [s] half the period of 10 Hz, and rounding
constexpr std::size_t kSheetTiles = 36;  // on the contact sheet of --every

void createFolder(const fs::path& dir) {
  std::error_code failed;
  if (!dir.empty()) fs::create_directories(dir, failed);
  if (failed) {
    throw OutputError(fmt::format("{}: cannot be created: {}", dir.string(), failed.message()));
  }
}

std::string lastPart(const std::string& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return (normal.has_filename() ? normal.filename() : normal.parent_path().filename()).string();
}

// `count` of `all`, evenly spread, the first and the last among them.
std::vector<std::size_t> spread(const std::vector<std::size_t>& all, std::size_t count) {
  if (all.size() <= count) return all;
  if (count == 1) return {all[all.size() / 2]};
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * (all.size() - 1) / (count - 1)]);
  return chosen;
}

}  // namespace

std::string SnapshotApp::description() const {
  return "Draws instants of a tracked run as PNG: objects, lidar returns, safety grid, truth.";
}

void SnapshotApp::declare(CLI::App& cli) {
  cli.add_option("-r,--run", run_dir, "folder of a run of perception-track")
      ->required()
      ->type_name("DIR");
  addInputOption(cli, false);
  addConfigOptions(cli, false);
  cli.add_option("-t,--truth", truth_file, "truth of the log, FILE.truth.csv")->type_name("FILE");
  auto* when = cli.add_option_group("when", "which instants");
  when->add_option("--time", time, "the scene nearest to this time of the log [s]");
  when->add_option("--frame", frame, "the scene of this frame of the log");
  when->add_option("--every", every, "a picture every so many seconds and a contact sheet [s]")
      ->check(CLI::Range(1e-3, 1e6));
  when->add_option("--contact", contact, "one sheet of so many instants, evenly over the run")
      ->check(CLI::Range(1, 100));
  when->require_option(1);
  cli.add_option("-o,--output", output, "PNG file; with --every a folder")->required();
  cli.add_option("--view", view, "from above, from behind the vehicle, or both")
      ->check(CLI::IsMember({"top", "driver", "both"}))
      ->capture_default_str();
  cli.add_option("--range", params.range, "how far ahead is shown [m]")
      ->check(CLI::Range(5.0, 200.0))
      ->capture_default_str();
  cli.add_option("--memory", memory, "lidar scans so long before an instant fill the grid [s]")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  cli.add_option("--title", title, "instead of the names of log and run");
}

// A site INI holds the sections of tracking, too: they are read, so that they count as known.
bool SnapshotApp::readConfig() {
  Config config = loadConfig();
  if (!config_file.empty()) {
    ground = PipelineSetup::read(config).ground;
  } else {
    ground = config.read<GroundParams>("ground", ground);
  }
  grid = config.read<GridParams>("grid", grid);
  return configDone(config);
}

std::size_t SnapshotApp::sceneAt(const TrackedRun& run, double t) const {
  const auto off = [&](std::size_t i) {
    return std::abs(run.scenes[i].stamp - run.first_stamp - t);
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < run.scenes.size(); ++i) {
    if (off(i) < off(best)) best = i;
  }
  if (off(best) > kNearestScene) {
    throw Error(ExitCode::kUsage,
                fmt::format("--time {:g}: {} has scenes from {:.2f} to {:.2f} s, none near", t,
                            run_dir, run.scenes.front().stamp - run.first_stamp,
                            run.scenes.back().stamp - run.first_stamp));
  }
  return best;
}

std::size_t SnapshotApp::sceneOf(const TrackedRun& run, std::int64_t number) const {
  for (std::size_t i = 0; i < run.scenes.size(); ++i) {
    if (run.scenes[i].frame == number) return i;
  }
  throw Error(ExitCode::kUsage,
              fmt::format("--frame {}: {} has no scene of it (first {}, last {})", number, run_dir,
                          run.scenes.front().frame, run.scenes.back().frame));
}

std::vector<std::size_t> SnapshotApp::chooseScenes(const TrackedRun& run) const {
  if (time) return {sceneAt(run, *time)};
  if (frame) return {sceneOf(run, *frame)};
  std::vector<std::size_t> chosen;
  Stamp due = run.scenes.front().stamp;
  for (std::size_t i = 0; i < run.scenes.size(); ++i) {
    if (run.scenes[i].stamp < due) continue;
    chosen.push_back(i);
    while (every > 0 && due <= run.scenes[i].stamp) due = due + every;
  }
  return every > 0 ? chosen : spread(chosen, static_cast<std::size_t>(contact));
}

// Log and run; a simulated result is called simulated.
std::string SnapshotApp::titleOf(const std::string& dir) {
  if (!title.empty()) return title;
  const std::string run = lastPart(dir);
  const fs::path record_file = fs::path(dir) / "done.json";
  if (!fs::exists(record_file)) {
    warn(fmt::format("{}: no done.json: the run did not finish", dir));
    return run + " (unfinished)";
  }
  const RunRecord record = readRunRecord(record_file.string());
  const std::string log = fs::path(record.input).filename().string();
  return fmt::format("{}{}, run {}", log, record.simulated ? " (simulated)" : "", run);
}

SceneView SnapshotApp::viewOf(const TrackedRun& run, std::size_t index) const {
  SceneView result;
  result.run_name = run_name_;
  result.scene = run.scenes[index];
  result.t = result.scene.stamp - run.first_stamp;
  result.class_names = run.class_names;
  result.trails = trailsUpTo(run.scenes, index, kTrail);
  addTruth(result);
  return result;
}

// By frame number where both have one, else by time.
void SnapshotApp::addTruth(SceneView& result) const {
  if (!truth_) return;
  result.has_truth = true;
  const GroundTruth::Instant* best = nullptr;
  for (const GroundTruth::Instant& instant : truth_->instants) {
    if (instant.frame >= 0 && result.scene.frame >= 0) {
      if (instant.frame == result.scene.frame) best = &instant;
    } else if (std::abs(instant.t - result.t) <=
               (best ? std::abs(best->t - result.t) : kNearestTruth)) {
      best = &instant;
    }
  }
  if (!best) return;
  for (const TruthObject& object : best->objects) {
    const bool whole = object.position.allFinite() && std::isfinite(object.yaw) &&
                       object.length > 0 && object.width > 0 && object.height > 0;
    if (whole && !object.ignore) result.truth.push_back(object);
  }
}

std::string SnapshotApp::fileFor(const SceneView& shown) const {
  if (every <= 0) return output;
  const auto ms = static_cast<long long>(std::llround(shown.t * 1000));
  return (fs::path(output) / fmt::format("t{:09d}ms.png", ms)).string();
}

void SnapshotApp::write(const std::string& path, Picture picture) {
  writePng(path, picture);
  out_files.push_back(path);
  out_picture = std::move(picture);
  say(1, path);
}

void SnapshotApp::run() {
  out_files.clear();
  if (readConfig()) return;
  if (inputs.size() > 1) throw Error(ExitCode::kUsage, "-i: one log, that of the run");
  params.views.clear();
  if (view != "driver") params.views.push_back(ViewKind::kTop);
  if (view != "top") params.views.push_back(ViewKind::kDriver);
  registerPerceptionClasses();
  const TrackedRun run = readTrackedRun(run_dir);
  if (run.scenes.empty()) throw DataError(run_dir + ": the run holds no scene");
  run_name_ = titleOf(run_dir);
  truth_.reset();
  if (!truth_file.empty()) truth_ = readGroundTruth(truth_file);
  const std::vector<std::size_t> chosen = chooseScenes(run);
  const std::vector<std::size_t> on_sheet = contact > 0 ? chosen
                                            : every > 0 ? spread(chosen, kSheetTiles)
                                                        : std::vector<std::size_t>{};
  std::unique_ptr<SnapshotLidar> lidar;
  if (!inputs.empty()) {
    lidar = std::make_unique<SnapshotLidar>(inputs[0], run, grid, ground, memory);
  }
  createFolder(every > 0 ? fs::path(output) : fs::path(output).parent_path());

  Snapshot snapshot(params);
  std::vector<Picture> tiles;
  SceneView shown;
  Progress progress("drawing", chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    stopIfAsked();
    shown = viewOf(run, chosen[i]);
    if (lidar) {
      lidar->advanceTo(shown.scene.stamp);
      lidar->fill(shown);
    }
    if (contact == 0) {
      write(fileFor(shown), snapshot.picture(shown));
      if (snapshot.labelsLeftOut() > 0) {
        say(1,
            fmt::format("t = {:.2f} s: no room for {} labels", shown.t, snapshot.labelsLeftOut()));
      }
    }
    if (std::binary_search(on_sheet.begin(), on_sheet.end(), chosen[i])) {
      tiles.push_back(snapshot.tile(shown));
    }
    progress.update(i + 1, i + 1);
  }
  if (!tiles.empty()) {
    const std::string path = every > 0 ? (fs::path(output) / "contact.png").string() : output;
    write(path, contactSheet(tiles, shown));
  }
  if (!lidar) return;
  const auto end = lidar->reader().end();
  if (end != RawlogReader::End::kNotYet && end != RawlogReader::End::kClean) {
    warn(lidar->reader().endMessage());
  }
  if (lidar->scans() == 0) {
    warn(fmt::format("{}: no lidar scan at the run's times", inputs[0]));
  }
}

}  // namespace perception
