#include "libperception/app/TrackApp.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "libperception/app/LogRecorder.h"
#include "libperception/app/OutputFolder.h"
#include "libperception/scene/MeasurementRun.h"
#include "libperception/scene/OutputFile.h"
#include "libperception/scene/TrackedRun.h"
#include "libperception/sensors/RawlogReader.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// Watches a log go by for what the results need besides scenes: is it simulated, which camera do
/// exports use.
struct LogFacts {
  bool simulated = false;
  std::optional<KittiCamera> camera;

  void look(const mrpt::obs::CObservation& observation) {
    if (const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(&observation)) {
      simulated = simulated || comment->text.rfind("simulated log", 0) == 0;
    }
    if (camera || !isSensorData(observation)) return;
    const auto frame = frameFromObservation(observation);
    const auto* detections = frame ? std::get_if<ObjectDetections>(&frame->data) : nullptr;
    if (!detections || detections->camera.width <= 0) return;
    // Boxes in space come in another sensor's frame: the camera's pose is only known from pure
    // image detections.
    for (const auto& o : detections->objects) {
      if (o.space_box || !o.image_box) return;
    }
    if (detections->objects.empty()) return;
    camera = KittiCamera{detections->camera, frame->T_ego_sensor,
                         simulated ? Vector3(Vector3::Zero()) : KittiCamera::kittiOffset()};
  }
};

/// Says in events.jsonl when objects come and go.
class ObjectEvents {
 public:
  ObjectEvents(const ClassTable& classes, EventLog& events) : classes_(classes), events_(events) {}

  void add(const Scene& scene) {
    std::set<std::uint64_t> now;
    for (const auto& o : scene.objects) {
      now.insert(o.id);
      const std::string& name = classes_[o.class_id].name;
      if (born_.insert(o.id).second) {
        events_.add(scene.stamp, event_kind::kTrackBorn, fmt::format("object {}", o.id),
                    {{"id", o.id}, {"class", name}});
      }
      if (o.classified && classified_.insert(o.id).second) {
        events_.add(scene.stamp, event_kind::kTrackConfirmed,
                    fmt::format("object {} is a {}", o.id, name), {{"id", o.id}, {"class", name}});
      }
    }
    for (const auto id : last_) {
      if (now.count(id) == 0)
        events_.add(scene.stamp, event_kind::kTrackLost, fmt::format("object {}", id),
                    {{"id", id}});
    }
    last_ = std::move(now);
  }

 private:
  const ClassTable& classes_;
  EventLog& events_;
  std::set<std::uint64_t> born_, classified_, last_;
};

/// Records what the front ends hand to the filter.
class MeasurementRecorder : public PipelineObserver {
 public:
  MeasurementRecorder(const std::string& dir, const Pipeline& pipeline)
      : pipeline_(pipeline), writer_(dir, pipeline.setup().model.classes) {}

  void onScan(const MeasurementScan& scan) override {
    const auto known = sensors_.find(scan.sensor);
    const RecordedSensor& sensor = known != sensors_.end() ? known->second : add(scan);
    writer_.write(recordScan(scan, sensor), sensor, *pipeline_.firstStamp());
  }
  void close() { writer_.close(); }

 private:
  const RecordedSensor& add(const MeasurementScan& scan) {
    RecordedSensor sensor = describeSensor(pipeline_.setup(), scan);
    writer_.writeSensor(sensor);
    return sensors_.emplace(scan.sensor, std::move(sensor)).first->second;
  }

  const Pipeline& pipeline_;
  MeasurementRunWriter writer_;
  std::map<std::string, RecordedSensor> sensors_;
};

}  // namespace

void TrackApp::declare(CLI::App& cli) {
  addConfigOptions(cli, true);
  addInputOption(cli, false);
  addOutputOption(cli, false);
  addRunOptions(cli);
  cli.add_option(
      "--sensors", sensors,
      "Modalities in use: C, C/H (camera headings as one wide Gaussian), L, R joined by +");
  cli.add_option("--seed", seed, "Seed of all random numbers");
  cli.add_option("--rate", rate,
                 "[Hz] Scenes at a fixed rate instead of at the output sensor's scans")
      ->check(CLI::Range(0.0, 1000.0));
  cli.add_flag("--measurements", measurements,
               "Record what the front ends found: measurements.csv, scans.csv, sensors.csv");
  cli.add_option("--export", exports,
                 "kitti:FILE: write the objects in KITTI's tracking format, too")
      ->allow_extra_args(false);
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
  // Several logs: one file each, told apart by the log's name.
  return (file.parent_path() / (fs::path(log).stem().string() + "." + file.filename().string()))
      .string();
}

Config TrackApp::configWithOptions() const {
  Config config = loadConfig();
  // As settings of [run], so that the effective INI says what was run.
  if (!sensors.empty()) config.set("run.sensors=" + sensors);
  if (seed) config.set(fmt::format("run.seed={}", *seed));
  if (measurements) config.set("run.write_measurements=true");
  if (rate > 0) config.set(fmt::format("run.output_rate={}", rate));
  return config;
}

void TrackApp::run() {
  registerPerceptionClasses();
  {
    Config config = configWithOptions();
    PipelineSetup::read(config);
    if (configDone(config)) return;
  }
  if (inputs.empty()) throw Error(ExitCode::kUsage, "-i/--input: at least one rawlog is needed");
  if (output.empty()) throw Error(ExitCode::kUsage, "-o/--output is needed");
  for (const auto& log : inputs) exportFileFor(log);
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
  for (const auto& log : inputs) {
    const std::string dir =
        inputs.size() == 1 ? output : output + "/" + fs::path(log).stem().string();
    trackLog(log, dir, exportFileFor(log));
  }
}

void TrackApp::trackLog(const std::string& log, const std::string& dir,
                        const std::string& export_file) {
  Config config = configWithOptions();
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  RawlogReader reader(log);
  OutputFolder folder(dir);
  const std::string written_to = fs::path(folder.pathFor("tracks.csv")).parent_path().string();
  folder.pathFor("scenes.csv");  // TrackedRunWriter writes both
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  std::optional<MeasurementRecorder> recorder;
  if (setup.run.write_measurements) {
    for (const char* name : {"measurements.csv", "scans.csv", "sensors.csv"}) folder.pathFor(name);
    recorder.emplace(written_to, pipeline);
    pipeline.observe(&*recorder);
  }
  ObjectEvents object_events(pipeline.setup().model.classes, events);
  LogFacts facts;
  std::optional<TrackedRunWriter> writer;
  std::optional<KittiExport> kitti;
  std::vector<Scene> before_camera;  // exports need a camera, and the log may show it late
  out_scenes.clear();
  out_record = {};
  std::set<std::uint64_t> ids;
  const std::string export_temporary = export_file.empty() ? "" : export_file + ".partial";

  const auto put = [&](const Scene& scene) {
    if (!writer) writer.emplace(written_to, setup.model.classes, *pipeline.firstStamp());
    writer->write(scene);
    object_events.add(scene);
    for (const auto& o : scene.objects) ids.insert(o.id);
    ++out_record.scenes;
    if (keep_scenes) out_scenes.push_back(scene);
    if (export_file.empty()) return;
    if (!kitti && facts.camera) {
      kitti.emplace(export_temporary, setup.model.classes, *facts.camera,
                    setup.scene.road_user_from);
      for (const auto& s : before_camera) kitti->write(s);
      before_camera.clear();
    }
    kitti ? kitti->write(scene) : before_camera.push_back(scene);
  };
  {
    Progress progress(log, reader.fileBytes());
    std::uint64_t count = 0;
    while (const auto observation = [&] {
      const auto scope = timing.stage("read");
      return reader.next();
    }()) {
      stopIfAsked();
      facts.look(*observation);
      pipeline.add(*observation);
      while (const auto scene = pipeline.next()) put(*scene);
      progress.update(reader.bytesRead(), ++count);
    }
  }
  while (const auto scene = pipeline.next(true)) put(*scene);
  pipeline.finish();

  if (reader.end() != RawlogReader::End::kClean) {
    if (strict) throw DataError(reader.endMessage());
    events.warn(reader.lastStamp(), event_kind::kLogDamaged, reader.endMessage());
    out_record.warnings.push_back(reader.endMessage());
    warn(reader.endMessage());
  }
  if (out_record.scenes == 0) {
    throw DataError(log + ": no scene came of it: the log holds no frame of a sensor in use (" +
                    setup.run.sensors + ")");
  }
  if (!export_file.empty() && !kitti) {
    throw DataError(log +
                    ": --export kitti needs a camera model, and the log's detections carry none");
  }
  for (const auto& [kind, n] : events.counts()) out_record.events[kind] = n;
  if (events.warnings() > out_record.warnings.size()) {
    const auto more = events.warnings() - out_record.warnings.size();
    out_record.warnings.push_back(fmt::format("{} warnings in events.jsonl", more));
    warn(fmt::format("{}: {} warnings, see {}/events.jsonl", log, more, dir));
  }
  const Stamp first = *pipeline.firstStamp();
  const double log_seconds = pipeline.lastStamp() - first;
  out_record.program = name();
  out_record.version = PERCEPTION_VERSION;
  out_record.input = log;
  out_record.input_bytes = reader.fileBytes();
  out_record.input_entries = reader.entries();
  out_record.input_end = nameOf(reader.end());
  out_record.input_end_detail =
      reader.end() == RawlogReader::End::kClean ? "" : reader.endMessage();
  out_record.simulated = facts.simulated;
  out_record.config = config_file;
  out_record.seed = setup.run.seed;
  out_record.sensors_used = setup.run.sensors;
  out_record.association =
      RunParams::associationNames()[static_cast<std::size_t>(setup.run.association)];
  out_record.particles = setup.particles.sample_size;
  out_record.first_stamp = first;
  out_record.last_stamp = pipeline.lastStamp();
  out_record.tracks = ids.size();
  out_record.sensors = pipeline.sensorRecords();
  writer->close();
  if (recorder) recorder->close();
  events.write(folder.pathFor("events.jsonl"), first);
  writeFile(folder.pathFor("effective.ini"), config.effectiveText());
  out_real_time_factor = log_seconds / std::max(timing.wallSeconds(), 1e-9);
  timing.write(folder.pathFor("timing.json"), log_seconds,
               threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency()));
  writeRunRecord(folder.pathFor("done.json"), out_record);
  if (kitti) {
    kitti->close();
    fs::rename(export_temporary, export_file);
  }
  folder.commit();
  fmt::print(
      "{}: {} scenes, {} objects, {:.1f} s of log in {:.1f} s ({:.1f} times real time), results in "
      "{}\n",
      log, out_record.scenes, out_record.tracks, log_seconds, timing.wallSeconds(),
      out_real_time_factor, dir);
}

}  // namespace perception
