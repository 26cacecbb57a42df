#include "libperception/pipeline/LogRun.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFewFrames = 10;  ///< of a lidar that may have seen nothing

}  // namespace

LogRun::LogRun(const PipelineSetup& setup, LogRunFiles files,
               std::unique_ptr<ObservationInput> input)
    : setup_(setup),
      files_(std::move(files)),
      input_(std::move(input)),
      folder_(files_.dir),
      pipeline_(setup_, events_, timing_),
      object_events_(pipeline_.setup().model.classes, events_) {
  written_to_ = fs::path(folder_.pathFor("tracks.csv")).parent_path().string();
  folder_.pathFor("scenes.csv");  // TrackedRunWriter writes both
  for (const auto& name : productsIn(files_.dir)) folder_.replace(name);
  if (!setup_.run.write_measurements) return;
  for (const char* name : {"measurements.csv", "scans.csv", "sensors.csv"}) folder_.pathFor(name);
  recorder_.emplace(written_to_, pipeline_);
  pipeline_.observe(&*recorder_);
}

void LogRun::watch(PipelineObserver& observer, EventLog::Listener events) {
  watcher_ = &observer;
  pipeline_.observe(watcher_);
  events_.tell(std::move(events));
}

void LogRun::put(const Scene& scene) {
  if (!writer_) writer_.emplace(written_to_, setup_.model.classes, *pipeline_.firstStamp());
  writer_->write(scene);
  object_events_.add(scene);
  if (object_events_.isFull()) object_events_.keepOnly(pipeline_.livingObjects());
  ++record.scenes;
  addLatency(scene.stamp);
  if (!files_.export_file.empty()) writeExport(scene);
}

void LogRun::addArrival(const mrpt::obs::CObservation& observation) {
  constexpr double kKept = 5;  // [s] longer than a scene waits
  const auto at = input_->arrival();
  const auto stamp = toStamp(observation.timestamp);
  if (!at || !stamp) return;
  arrivals_[*stamp] = *at;
  while (*stamp - arrivals_.begin()->first > kKept) arrivals_.erase(arrivals_.begin());
}

/// Since the first observation at or behind the scene's instant came.
void LogRun::addLatency(Stamp scene) {
  latency_.reset();
  const auto arrival = arrivals_.lower_bound(scene);
  if (arrival == arrivals_.end()) return;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - arrival->second;
  latency_ = passed.count();
  timing_.addLatency(*latency_);
}

// Only of runs whose returns are weighed.
void LogRun::putWeather() {
  for (const WeatherRow& row : pipeline_.takeWeather()) {
    if (!weather_) weather_.emplace(folder_.pathFor("weather.csv"), *pipeline_.firstStamp());
    weather_->write(row);
    if (watcher_) watcher_->onWeather(row);
  }
}

// Of the same runs.
void LogRun::putLedger() {
  for (const LedgerRow& row : pipeline_.takeLedger()) {
    if (!ledger_) ledger_.emplace(folder_.pathFor("ledger.csv"), *pipeline_.firstStamp());
    ledger_->write(row);
  }
}

void LogRun::writeExport(const Scene& scene) {
  if (!kitti_ && facts_.camera) {
    kitti_.emplace(files_.export_file, setup_.model.classes, *facts_.camera,
                   KittiSelection{setup_.scene.road_user_from, setup_.scene.in_image});
    for (const auto& s : before_camera_) kitti_->write(s);
    before_camera_.clear();
  }
  kitti_ ? kitti_->write(scene) : before_camera_.push_back(scene);
}

void LogRun::read(const std::function<void(const Scene&)>& keep) {
  const auto take = [&](bool end) {
    for (;;) {
      const std::uint64_t made = pipeline_.made();
      const auto scene = pipeline_.next(end);
      for (; held_ < pipeline_.made(); ++held_) events_.hold();  // where it would be put at once
      if (scene) {
        events_.release([&] { put(*scene); });
        keep(*scene);
      } else if (made == pipeline_.made()) {
        break;
      }
    }
    putWeather();
    putLedger();
  };
  {
    Progress progress(files_.log, input_->fileBytes());
    std::uint64_t count = 0;
    while (const auto observation = [&] {
      const auto scope = timing_.stage("read");
      return input_->next();
    }()) {
      addArrival(*observation);
      if (!input_->arrival()) stopIfAsked();  // sensors at work end their input themselves
      facts_.look(*observation);
      contents_.look(*observation);
      if (observation.use_count() == 1) {
        pipeline_.add(std::move(*observation));
      } else {  // something else still needs its points
        pipeline_.add(*observation);
      }
      if (!events_.isWritten() && pipeline_.firstStamp())
        events_.writeTo(folder_.pathFor("events.jsonl"), *pipeline_.firstStamp());
      take(false);
      progress.update(input_->bytesRead(), ++count);
    }
  }
  take(true);
  pipeline_.finish();
}

std::vector<std::string> LogRun::finish(bool strict) {
  std::vector<std::string> said;
  if (!input_->isComplete()) {
    if (strict) throw DataError(input_->endMessage());
    events_.warn(input_->lastStamp(), event_kind::kLogDamaged, input_->endMessage());
    record.warnings.push_back(input_->endMessage());
    said.push_back(input_->endMessage());
  }
  if (input_->dropped() > 0) {
    said.push_back(fmt::format("{}: {} observations came faster than they were taken", files_.log,
                               input_->dropped()));
    events_.warn(input_->lastStamp(), event_kind::kDroppedFrame, said.back());
    record.warnings.push_back(said.back());
  }
  if (record.scenes == 0)
    throw DataError(noSceneMessage(files_.log, contents_, setup_, input_->endMessage()));
  if (!files_.export_file.empty() && !kitti_) {
    throw DataError(files_.log +
                    ": --export kitti needs a camera model, and the log's detections carry none");
  }
  for (const SensorRecord& sensor : pipeline_.sensorRecords()) {
    if (sensor.modality != "L" || sensor.frames < kFewFrames || sensor.measurements > 0) continue;
    events_.warn(std::nullopt, event_kind::kSensorBlind,
                 fmt::format("'{}': {} scans and no measurement came of them: is it a planar or "
                             "low scanner, or are height, pitch or range_max of its section wrong? "
                             "perception-doctor looks into it",
                             sensor.label, sensor.frames));
  }
  if (const auto lost = writer_->notFinite(); lost > 0) {
    events_.warn(pipeline_.lastStamp(), event_kind::kFilterReset,
                 fmt::format("{} states of objects are not written: they are not finite", lost),
                 {{"states", lost}});
  }
  for (const auto& [kind, n] : events_.counts()) record.events[kind] = n;
  if (events_.warnings() > record.warnings.size()) {
    const auto more = events_.warnings() - record.warnings.size();
    record.warnings.push_back(fmt::format("{} warnings in events.jsonl", more));
    for (const auto& message : events_.firstWarnings())
      said.push_back(fmt::format("{}: {}", files_.log, message));
    if (more > EventLog::kFirst)
      said.push_back(
          fmt::format("{}: {} warnings in all, see {}/events.jsonl", files_.log, more, files_.dir));
  }
  return said;
}

void LogRun::fillRecord() {
  record.input = files_.log;
  record.input_bytes = input_->fileBytes();
  record.input_entries = input_->entries();
  record.input_end = input_->endName();
  record.input_end_detail = input_->isComplete() ? "" : input_->endMessage();
  record.input_verifiable = input_->verifiable();
  record.simulated = facts_.simulated;
  record.weather = facts_.weather;
  record.seed = setup_.run.seed;
  record.sensors_used = setup_.run.sensors;
  record.association =
      RunParams::associationNames()[static_cast<std::size_t>(setup_.run.association)];
  record.particles = setup_.particles.sample_size;
  record.first_stamp = *pipeline_.firstStamp();
  record.last_stamp = pipeline_.lastStamp();
  record.tracks = object_events_.objects();
  record.sensors = pipeline_.sensorRecords();
}

double LogRun::realTimeFactor() const {
  return logSeconds() / std::max(timing_.wallSeconds(), 1e-9);
}

void LogRun::commit(const std::string& effective_ini, int threads) {
  fillRecord();
  writer_->close();
  if (recorder_) recorder_->close();
  if (weather_) weather_->close();
  if (ledger_) ledger_->close();
  events_.close();
  writeFile(folder_.pathFor("innovations.csv"),
            innovationsCsv(pipeline_.innovations(), setup_.model.classes));
  writeFile(folder_.pathFor("effective.ini"), effective_ini);
  timing_.write(folder_.pathFor("timing.json"), logSeconds(), threads);
  writeRunRecord(folder_.pathFor("done.json"), record);
  if (kitti_) kitti_->close();
  folder_.commit();
}

}  // namespace perception
