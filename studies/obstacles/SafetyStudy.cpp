#include "studies/obstacles/SafetyStudy.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <deque>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <utility>

#include "libperception/calibration/clusters/PointLabels.h"
#include "libperception/core/Error.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "studies/obstacles/WayTruth.h"

namespace perception {
namespace {

constexpr const char* kMonitors[] = {"Euclidean clusters", "grid, every return trusted",
                                     "advice of the run"};
constexpr std::size_t kMonitorCount = std::size(kMonitors);
constexpr double kGrow = 0.3;             // [m] of a track's outline
constexpr int kPhantomReturns = 3;        // that a phantom track stands on
constexpr std::size_t kPhantomScans = 3;  // from which a track counts as one

/// Counts of one log.
struct SafetyCounts {
  std::string log;
  double minutes = 0;
  std::size_t scans = 0, unlabeled = 0;
  std::array<StopCount, kMonitorCount> stops;
  std::size_t phantom_tracks = 0;  ///< ids that stood on phantoms in three scenes
  std::size_t phantom_users = 0;   ///< of these: surely a road user in one of them
  std::size_t on_objects = 0;      ///< of these: in more scenes on a surface

  SafetyCounts& operator+=(const SafetyCounts& other) {
    minutes += other.minutes, scans += other.scans, unlabeled += other.unlabeled;
    for (std::size_t k = 0; k < kMonitorCount; ++k) stops[k] += other.stops[k];
    phantom_tracks += other.phantom_tracks, phantom_users += other.phantom_users;
    on_objects += other.on_objects;
    return *this;
  }
};

/// A labeled scan that waits for its scene.
struct JudgedScan {
  Stamp stamp;
  LabeledObstacles obstacles;
  std::array<bool, kMonitorCount - 1> stops;  // of the monitors without tracks
  InTheWay real;                              // what is in the way
};

/// Judges every labeled scan, then the scene of its instant, which may be made later.
class SafetyObserver : public PipelineObserver {
 public:
  SafetyObserver(const std::string& log, const PipelineSetup& setup)
      : labels_(log),
        classes_(setup.model.classes),
        stop_(setup.stop),
        speeds_(log),
        trusting_(std::make_unique<SafetyMonitor>(setup.grid, setup.stop)) {
    counts.log = std::filesystem::path(log).stem().string();
  }

  void onFrame(const SensorFrame& frame) override {
    frame_.reset();
    const auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr) return;
    scan_labels_ = labels_.ofFrame(frame.frame, cloud->size());
    if (!scan_labels_) {
      ++counts.unlabeled;
      return;
    }
    frame_ = frame;
  }

  void onScan(const MeasurementScan& scan) override {
    if (!frame_ || !scan.returns) return;
    if (!first_) first_ = frame_->stamp;
    std::get<LidarCloud>(frame_->data).trust.clear();
    PlacedReturns plain = *scan.returns;
    plain.phantom.clear();
    trusting_->add(*frame_, plain);
    JudgedScan judged{frame_->stamp, {}, {}, {}};
    judged.obstacles = obstaclesOf(*scan.returns, frame_->ego.T_world_ego, *scan_labels_);
    truth_.add(frame_->stamp, frame_->stamp - *first_, judged.obstacles, speeds_);
    judgeWay(frame_->ego, *scan.returns, judged);
    waiting_.push_back(std::move(judged));
  }

  void onOutput(const Scene& scene) override {
    while (!waiting_.empty() && waiting_.front().stamp < scene.stamp) waiting_.pop_front();
    if (waiting_.empty() || waiting_.front().stamp != scene.stamp || !scene.path) return;
    if (counts.scans > 0) counts.minutes += (scene.stamp - last_) / 60;
    last_ = scene.stamp;
    ++counts.scans;
    const JudgedScan& judged = waiting_.front();
    for (std::size_t k = 0; k < kMonitorCount; ++k)
      counts.stops[k].add(scene.stamp, k < judged.stops.size() ? judged.stops[k] : scene.path->stop,
                          judged.real);
    for (const SceneObject& object : scene.objects) judgeTrack(object, judged.obstacles);
  }

  void finish() {
    for (const auto& [id, scans] : on_phantoms_) {
      if (scans < kPhantomScans) continue;
      ++counts.phantom_tracks;
      counts.phantom_users += sure_.count(id) > 0;
      const auto on_surface = on_surfaces_.find(id);
      counts.on_objects += on_surface != on_surfaces_.end() && on_surface->second > scans;
    }
  }

  SafetyCounts counts;

 private:
  /// What is in the way, and which of the monitors without tracks stop for it.
  void judgeWay(const EgoState& ego, const PlacedReturns& returns, JudgedScan& judged) {
    StopRule rule;
    rule.corridor = drivenCorridor(ego.T_world_ego, ego.velocity, ego.yaw_rate,
                                   returns.vehicle_front, returns.vehicle_rear, stop_);
    rule.params = stop_;
    rule.t = judged.stamp - *first_;
    rule.speed = ego.velocity.norm();
    rule.speeds = &speeds_;
    const auto aheadOf = [](const FreeDistance& free) {
      return free.blocked ? Ahead{free.distance, free.place} : Ahead{};
    };
    judged.real = truth_.judge(judged.stamp, rule);
    judged.stops = {rule.within(nearestCluster(judged.obstacles, rule.corridor)) > 0,
                    rule.within(aheadOf(trusting_->pathAhead(ego).free)) > 0};
  }

  void judgeTrack(const SceneObject& object, const LabeledObstacles& obstacles) {
    int phantoms = 0, surfaces = 0;
    for (std::size_t i = 0; i < obstacles.place.size(); ++i) {
      const Vector2 p =
          rotate2(-object.yaw, obstacles.place[i].head<2>() - Vector2(object.position.head<2>()));
      if (std::abs(p.x()) > object.length / 2 + kGrow) continue;
      if (std::abs(p.y()) > object.width / 2 + kGrow) continue;
      phantoms += obstacles.phantom[i], surfaces += obstacles.surface[i];
    }
    on_surfaces_[object.id] += surfaces > phantoms;
    if (phantoms < kPhantomReturns || phantoms <= surfaces) return;
    ++on_phantoms_[object.id];
    if (object.classified && classes_[object.class_id].reported) ++sure_[object.id];
  }

  PointLabels labels_;
  ClassTable classes_;
  StopParams stop_;
  TruthSpeeds speeds_;
  std::unique_ptr<SafetyMonitor> trusting_;
  std::optional<Stamp> first_;
  std::optional<SensorFrame> frame_;
  std::optional<std::vector<std::uint16_t>> scan_labels_;
  WayTruth truth_;
  std::deque<JudgedScan> waiting_;
  Stamp last_;
  std::map<std::uint64_t, std::size_t> on_phantoms_, on_surfaces_, sure_;
};

std::string perMinute(std::size_t count, double minutes) {
  return minutes > 0 ? fmt::format("{:.1f}", static_cast<double>(count) / minutes) : "n/a";
}

std::vector<std::string> stopRow(const SafetyCounts& counts, std::size_t k) {
  const StopCount& stops = counts.stops[k];
  return {counts.log,
          kMonitors[k],
          fmt::format("{}", stops.rightly.stops),
          fmt::format("{}", stops.falsely.stops),
          fmt::format("{}", stops.falsely.scans),
          perMinute(stops.falsely.stops, counts.minutes),
          fmt::format("{}", stops.missed.stops),
          fmt::format("{}", stops.missed.scans)};
}

SafetyCounts countLog(const std::string& log, const SafetyOptions& options,
                      unsigned long long seed) {
  std::vector<std::string> settings = options.settings;
  settings.push_back(fmt::format("run.seed={}", seed));
  PipelineSetup setup = PipelineSetup::fromFile(options.config, settings);
  if (!setup.grid.enabled) throw ConfigError(options.config + ": [grid] enabled must be true");
  SafetyObserver observer(log, setup);
  passLog(log, std::move(setup), options.seconds, observer);
  observer.finish();
  if (observer.counts.scans == 0)
    throw DataError(log + ": no scan of a lidar in use has labels in " + observer.counts.log +
                    "_Labels/ beside the log");
  return observer.counts;
}

}  // namespace

void declareSafety(CLI::App& cli, SafetyOptions& o) {
  cli.add_option("-i,--input", o.logs, "Rawlogs with labels of points in LOG_Labels/")
      ->required()
      ->check(CLI::ExistingFile);
  cli.add_option("-c,--config", o.config, "INI of the vehicle")
      ->capture_default_str()
      ->check(CLI::ExistingFile);
  cli.add_option("--set", o.settings, "section.key=value: overrides the INI");
  cli.add_option("--seconds", o.seconds, "Of each log; 0 = all")->check(CLI::Range(0.0, 1e6));
}

StudyReport safetyStudy(const SafetyOptions& options, unsigned long long seed) {
  StudyTable stops = {"stops",
                      "Stops for what is in the driven path",
                      {"log", "monitor", "right stops", "false stops", "false scans",
                       "false stops a minute", "missed stops", "missed scans"},
                      {}};
  StudyTable tracks = {
      "phantom_tracks",
      "Tracks that stand on phantoms in three scenes or more",
      {"log", "minutes", "tracks", "a minute", "surely a road user", "a minute", "of an object"},
      {}};
  SafetyCounts all;
  all.log = "all";
  const auto addRows = [&](const SafetyCounts& counts) {
    for (std::size_t k = 0; k < kMonitorCount; ++k) stops.rows.push_back(stopRow(counts, k));
    tracks.rows.push_back(
        {counts.log, fmt::format("{:.2f}", counts.minutes),
         fmt::format("{}", counts.phantom_tracks), perMinute(counts.phantom_tracks, counts.minutes),
         fmt::format("{}", counts.phantom_users), perMinute(counts.phantom_users, counts.minutes),
         fmt::format("{}", counts.on_objects)});
  };
  for (const std::string& log : options.logs) {
    const SafetyCounts counts = countLog(log, options, seed);
    addRows(counts);
    all += counts;
  }
  if (options.logs.size() > 1) addRows(all);
  StudyReport report;
  report.title = "Stops and phantom tracks against labels of returns";
  report.data = fmt::format("{} logs, {} scans, {:.2f} min, {}", options.logs.size(), all.scans,
                            all.minutes, options.config);
  report.tables = {std::move(stops), std::move(tracks)};
  report.remarks = {
      "A stop: an obstacle within the stopping distance along the driven arc; the way that an "
      "obstacle ahead still covers is taken off: by its true speed for clusters and the plain "
      "grid, "
      "by that of the tracks for the run's advice (trust, clusters told by shape, grid, tracks).",
      "False: no surface within that distance and a meter more in the last half second. Missed: "
      "three "
      "returns of a surface for three scans, and no stop. Scans apart by at most .5 s are one "
      "stop.",
      "Of an object: these tracks stand on a surface in more scenes than on phantoms; a vehicle in "
      "its own spray, for example.",
      "Of a simulated log, everything here is simulated."};
  for (const std::string& log : options.logs) {
    if (!std::filesystem::exists(truthFileOf(log)))
      report.remarks.push_back(log +
                               " has no truth: what drives ahead counts as standing, and the run's "
                               "advice, which knows better, as missing it.");
  }
  if (all.unlabeled > 0)
    report.remarks.push_back(fmt::format("{} scans have no labels.", all.unlabeled));
  return report;
}

}  // namespace perception
