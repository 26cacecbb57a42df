#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/clouds/CloudTable.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/street_sets/NuscenesTables.h"
#include "libperception/interop/exports/NuscenesFile.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr double kHdl32Range = 100;   // [m] of the HDL-32E by its data sheet
constexpr double kArs408Range = 250;  // [m] of the ARS 408 by its data sheet
/// States of a radar's target: valid, and the Doppler speed is not ambiguous.
constexpr double kValid = 0, kUnambiguous = 3;

/// One scene of nuScenes: lidar, radars, cameras, poses, boxes of the key frames.
class NuscenesImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_,
                   "folder with v1.0-mini/ (or another --version), samples/, sweeps/")
        ->required();
    cli.add_option("--version", version_, "folder of the tables")->capture_default_str();
    cli.add_option("--scene", scene_,
                   "name of the drive, as scene-0061; not needed if there is one");
    cli.add_option("--channels", channels_, "sensors that are wanted; default: all")
        ->delimiter(',');
    cli.add_flag("--list", list_, "prints the scenes, writes nothing");
  }
  bool runInstead(const std::string&) override {
    if (!list_) return false;
    for (const NuscenesScene& s : readNuscenesScenes(tables()))
      fmt::print("{}  {} key frames  {}\n", s.name, s.samples, s.description);
    return true;
  }
  void run(ImportLog& log) override;

 private:
  std::string tables() const { return (fs::path(dir_) / version_).string(); }
  void keepSamples(const NuscenesDrive& drive, const std::map<std::int64_t, Stamp>& stamps,
                   const ImportLog& log) const;
  NuscenesScene chosenScene() const;
  bool wanted(const NuscenesSensor& sensor) const {
    return channels_.empty() ||
           std::find(channels_.begin(), channels_.end(), sensor.channel) != channels_.end();
  }
  void queue(const NuscenesData& data, const NuscenesSensor& sensor, ImportLog& log);
  void queueTruth(const NuscenesDrive& drive, const std::map<std::int64_t, Stamp>& stamps,
                  ImportLog& log) const;

  std::string dir_, version_ = "v1.0-mini", scene_;
  std::vector<std::string> channels_;
  bool list_ = false;
  Pose3 T_world_global_ = Pose3::Identity();
  std::map<std::string, std::int64_t> absent_;  ///< files that are not there, by channel
};

NuscenesScene NuscenesImporter::chosenScene() const {
  const auto scenes = readNuscenesScenes(tables());
  std::string names;
  for (const NuscenesScene& s : scenes) {
    if (s.name == scene_ || (scene_.empty() && scenes.size() == 1)) return s;
    if (names.size() < 200) names += (names.empty() ? "" : ", ") + s.name;
  }
  failUsage(fmt::format("--scene {}: {} has {} scenes: {}{}", scene_, tables(), scenes.size(),
                        names, names.size() < 200 ? "" : " ... (--list)"));
}

/// The targets of a file, in the sensor's frame; vx and vy are its speed along the beam.
RadarReturns nuscenesReturns(const std::string& path) {
  const CloudTable table = readPcd(path, readBytes(path));
  const auto column = [&](const char* name) -> const std::vector<double>& {
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      if (table.columns[c].name == name) return table.values[c];
    throw DataError(fmt::format("{}: no field {}", path, name));
  };
  const auto &x = column("x"), &y = column("y"), &vx = column("vx"), &vy = column("vy");
  const auto &rcs = column("rcs"), &id = column("id");
  const auto &invalid = column("invalid_state"), &ambiguous = column("ambig_state");
  RadarReturns radar;
  radar.max_range = kArs408Range;
  for (std::size_t i = 0; i < table.rows; ++i) {
    RadarReturn r;
    r.range = std::hypot(x[i], y[i]);
    if (invalid[i] != kValid || ambiguous[i] != kUnambiguous || !(r.range > 0)) continue;
    r.bearing = std::atan2(y[i], x[i]);
    r.range_rate = (vx[i] * x[i] + vy[i] * y[i]) / r.range;
    r.amplitude = rcs[i];
    r.id = static_cast<std::int32_t>(id[i]);
    radar.returns.push_back(r);
  }
  return radar;
}

/// Reads the file when its turn comes: a scene has thousands.
void NuscenesImporter::queue(const NuscenesData& data, const NuscenesSensor& sensor,
                             ImportLog& log) {
  const std::string path = (fs::path(dir_) / data.file).string();
  const bool lidar = sensor.modality == "lidar";
  if (!fs::exists(path)) {
    if (lidar && data.key) {
      log.missing("scan", (fs::path(dir_) / data.file).parent_path().string(), data.sample);
    } else {
      ++absent_[sensor.channel];
    }
    return;
  }
  if (sensor.modality == "camera") {
    ImportedImage image;
    image.label = sensor.channel, image.path = path, image.stamp = data.stamp;
    image.camera.fx = sensor.fx, image.camera.fy = sensor.fy;
    image.camera.cx = sensor.cx, image.camera.cy = sensor.cy;
    image.T_ego_camera = sensor.T_ego_sensor;
    log.at(data.stamp, [image, sample = data.sample, &log] { log.image(image, sample); });
    return;
  }
  log.at(data.stamp, [=, &log] {
    if (lidar) {
      CloudFormat format;
      format.columns = {"x", "y", "z", "intensity", "ring"};
      format.intensity_max = 255, format.max_range = kHdl32Range;
      LidarCloud cloud = readCloudFile(path, format);
      log.ego(data.stamp, T_world_global_ * data.T_global_ego);
      if (data.key) log.frame(data.stamp, data.sample);
      log.sensor(sensor.channel, data.stamp, sensor.T_ego_sensor, std::move(cloud));
    } else {
      log.sensor(sensor.channel, data.stamp, sensor.T_ego_sensor, nuscenesReturns(path));
    }
  });
}

/// Boxes stand at the lidar's scans of their key frames.
void NuscenesImporter::queueTruth(const NuscenesDrive& drive,
                                  const std::map<std::int64_t, Stamp>& stamps,
                                  ImportLog& log) const {
  const Pose3& T = T_world_global_;
  const double turn = std::atan2(T.linear()(1, 0), T.linear()(0, 0));
  for (const NuscenesBox& box : drive.boxes) {
    const auto stamp = stamps.find(box.sample);
    if (stamp == stamps.end()) continue;
    TruthObject object = box.object;
    object.frame = box.sample;
    object.position = T * object.position;
    object.yaw = wrapAngle(object.yaw + turn);
    log.truth(stamp->second, std::move(object));
  }
}

/// What perception-export needs to give tracks back to the data set.
void NuscenesImporter::keepSamples(const NuscenesDrive& drive,
                                   const std::map<std::int64_t, Stamp>& stamps,
                                   const ImportLog& log) const {
  NuscenesSamples samples;
  samples.T_global_world = T_world_global_.inverse();
  for (const auto& row : stamps)
    samples.tokens.emplace_back(row.first,
                                drive.sample_tokens[static_cast<std::size_t>(row.first)]);
  writeNuscenesSamples(samplesFileOf(log.options().output), samples);
}

void NuscenesImporter::run(ImportLog& log) {
  requireFolder(dir_);
  const NuscenesScene scene = chosenScene();
  const NuscenesDrive drive = readNuscenesDrive(tables(), scene);
  std::map<std::int64_t, Stamp> stamps;  // of the key frames' lidar scans
  bool first = true;
  for (const NuscenesData& data : drive.data) {
    const NuscenesSensor& sensor = drive.sensors[data.sensor];
    if (!log.wants(data.sample) || !wanted(sensor)) continue;
    if (first) T_world_global_ = data.T_global_ego.inverse();
    first = false;
    if (data.key && sensor.modality == "lidar") stamps[data.sample] = data.stamp;
    queue(data, sensor, log);
  }
  log.writeInOrder();
  log.expectTruth();
  queueTruth(drive, stamps, log);
  keepSamples(drive, stamps, log);
  log.note(fmt::format("{}: {}", scene.name, scene.description));
  for (const auto& [channel, count] : absent_)
    log.warn(fmt::format("{}: {} files are not there: left out", channel, count));
}

}  // namespace

std::unique_ptr<Importer> makeNuscenesImporter() { return std::make_unique<NuscenesImporter>(); }

}  // namespace perception
