#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/input/LogContents.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/watches/LogWatchers.h"
#include "libperception/scene/files/KittiExport.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/sensors/rawlog/ObservationInput.h"

namespace perception {

/// Input and output paths of one run.
struct LogRunFiles {
  std::string log, dir;
  std::string export_file;  ///< KITTI's tracking format; empty: none
};

/// Tracks one log, or sensors at work, into one result folder. Call read(), finish(), commit(),
/// each once.
class LogRun {
 public:
  /// Throws OutputError or Error for the folder.
  LogRun(const PipelineSetup& setup, LogRunFiles files, std::unique_ptr<ObservationInput> input);

  /// Lets an observer see the run, including the weather and, by EventLog::Listener, events. Call
  /// before read(). The observer is not owned and must outlive read().
  void watch(PipelineObserver& observer, EventLog::Listener events);
  /// The same for events alone.
  void listen(EventLog::Listener events) { events_.tell(std::move(events)); }
  /// As Pipeline::letGridLag(), for a log that is not watched: listeners hear of events late.
  void letGridLag() { pipeline_.letGridLag(); }
  /// Processes the log to its end; `keep` is called with each scene.
  void read(const std::function<void(const Scene&)>& keep);
  /// Returns warnings. Throws DataError when there is no scene, or when the log is damaged and
  /// `strict`.
  std::vector<std::string> finish(bool strict);
  /// Completes the record and writes the remaining files, done.json last.
  void commit(const std::string& effective_ini, int threads);

  RunRecord record;  ///< program and configuration are set by the caller
  /// What was learned of detectors: INI lines.
  std::vector<std::string> learned() const { return pipeline_.learned(); }
  // As of the last scene.
  std::optional<Stamp> firstStamp() const { return pipeline_.firstStamp(); }
  const SafetyGrid* grid() const { return pipeline_.grid(); }
  bool simulated() const { return facts_.simulated; }
  /// [s] between the arrival of the observation that the scene waited for and the scene; empty for
  /// a log.
  std::optional<double> latency() const { return latency_; }
  const RunTiming& timing() const { return timing_; }
  double wallSeconds() const { return timing_.wallSeconds(); }
  double realTimeFactor() const;  ///< seconds of log per second of work

 private:
  void put(const Scene& scene);
  void addArrival(const mrpt::obs::CObservation& observation);
  void addLatency(Stamp scene);
  void putWeather();
  void putLedger();
  void writeExport(const Scene& scene);
  void fillRecord();
  double logSeconds() const { return pipeline_.lastStamp() - *pipeline_.firstStamp(); }

  const PipelineSetup setup_;
  const LogRunFiles files_;
  const std::unique_ptr<ObservationInput> input_;
  OutputFolder folder_;
  std::string written_to_;  ///< temporary folder until commit()
  EventLog events_;
  RunTiming timing_;
  Pipeline pipeline_;
  ObjectEvents object_events_;
  LogFacts facts_;
  LogContents contents_;
  std::optional<MeasurementRecorder> recorder_;
  std::optional<TrackedRunWriter> writer_;
  std::optional<WeatherFile> weather_;
  std::optional<LedgerFile> ledger_;
  std::optional<KittiExport> kitti_;
  /// In a live run, when the sensor data of an instant arrived; the last five seconds.
  std::map<Stamp, std::chrono::steady_clock::time_point> arrivals_;
  std::optional<double> latency_;        ///< [s] of the last scene
  std::uint64_t held_ = 0;               ///< scenes for which events wait or waited
  PipelineObserver* watcher_ = nullptr;  ///< of watch()
  std::vector<Scene>
      before_camera_;  ///< scenes before the first camera observation, which exports need
};

}  // namespace perception
