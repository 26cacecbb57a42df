#pragma once
#include <mrpt/obs/CObservation.h>

#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "libperception/core/system/Parallel.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/ScanMaker.h"
#include "libperception/pipeline/health/SensorHealth.h"
#include "libperception/pipeline/input/EgoTimeline.h"
#include "libperception/pipeline/input/FrameNumbers.h"
#include "libperception/pipeline/input/FrameQueue.h"
#include "libperception/pipeline/output/OutputSchedule.h"
#include "libperception/pipeline/phantoms/PhantomLedger.h"
#include "libperception/pipeline/phantoms/WakeWatch.h"
#include "libperception/pipeline/phantoms/WeatherWatch.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"
#include "libperception/pipeline/watches/ConditionWatch.h"
#include "libperception/pipeline/watches/InnovationWatch.h"
#include "libperception/pipeline/watches/InputWatch.h"
#include "libperception/pipeline/watches/SensorWatch.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/RunTiming.h"

namespace perception {

/// Observer of a pipeline's data flow, called in order, for recording and replay.
class PipelineObserver {
 public:
  virtual ~PipelineObserver() = default;
  /// Called with each sensor frame before its front end turns it into a scan.
  virtual void onFrame(const SensorFrame& frame) { (void)frame; }
  virtual void onScan(const MeasurementScan& scan) { (void)scan; }  ///< goes into the filter
  /// The way ahead of a scene that is due; before its onScene().
  virtual void onPath(const PathAhead& path) { (void)path; }
  /// A scene of this instant is due.
  virtual void onScene(const EgoState& ego, std::int64_t frame) { (void)ego, (void)frame; }
  /// A lidar scan's weather; from passLog() and LogRun.
  virtual void onWeather(const WeatherRow& row) { (void)row; }
  /// Called with each scene when it is output; with [run] output_lag, that is later than its
  /// instant.
  virtual void onOutput(const Scene& scene) { (void)scene; }
  virtual void onRestart() {}  ///< all tracks are deleted
};

/// From observations to scenes: connects sensors, front ends, filter and scene. Call add() with
/// each observation, then next() until it returns none; at the end of the log next() with `flush`.
class Pipeline {
 public:
  Pipeline(PipelineSetup setup, EventLog& events, RunTiming& timing);
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Lets the grid of a scan and the way ahead be worked on while the next scan is prepared, where
  /// there are two threads: of a log, whose scenes need not come at once. Each then comes when the
  /// scene after the next one is due, and is the same. grid() is not to be asked for until the log
  /// has ended. No effect on scenes with a lag.
  void letGridLag();

  void add(const mrpt::obs::CObservation& observation) { add(observation, nullptr); }
  /// One that is not needed any more: its points are moved.
  void add(mrpt::obs::CObservation&& observation) { add(observation, &observation); }
  /// The next scene; empty: a scene was made but is late (made()), or more observations are needed.
  std::optional<Scene> next(bool flush = false);
  /// Number of scenes that were made so far, those included that next() has not given yet.
  std::uint64_t made() const { return made_; }
  /// Reports events known at the end of the log: sensors without frames, labels without a section,
  /// what was learned of detectors, what was taken as phantoms.
  void finish();
  /// What was learned of detectors and clutter so far: INI lines, section by section.
  std::vector<std::string> learned() const;
  /// Called from now on, in the order of these calls. Not owned.
  void observe(PipelineObserver* observer) { observers_.push_back(observer); }
  /// The safety grid as of the last scan; null: [grid] enabled = false.
  const SafetyGrid* grid() const { return safety_ ? &safety_->grid() : nullptr; }

  const CRbpfTracker& tracker() const { return tracker_; }
  const PipelineSetup& setup() const { return setup_; }
  std::optional<Stamp> firstStamp() const { return first_stamp_; }  ///< of the log; t = 0
  Stamp lastStamp() const { return last_stamp_; }
  std::vector<SensorRecord> sensorRecords() const { return watch_.records(); }
  /// What lidar scans showed of the weather since the last call.
  std::vector<WeatherRow> takeWeather() { return weather_.take(); }
  /// What was taken as phantoms since the last call.
  std::vector<LedgerRow> takeLedger() { return ledger_.take(); }
  const InnovationWatch::Sums& innovations() const { return innovations_.sums(); }
  std::uint64_t objects() const { return scenes_.objectsSoFar(); }
  /// Ids that may be in a later scene, besides new ones. Forgets all others, to bound the memory of
  /// a long run.
  std::set<std::uint64_t> livingObjects();

 private:
  /// A scene that waits for its way.
  struct LateScene {
    OutputSchedule::Instant instant;
    Scene scene;
    std::size_t work;  ///< number of the work that finds its way
  };

  void addTime(Stamp stamp);
  void passGap(Stamp stamp, double gap);
  void startEpoch(Stamp stamp, const std::string& why);
  /// `own`: the observation, if it is not needed any more; else null.
  void add(const mrpt::obs::CObservation& observation, mrpt::obs::CObservation* own);
  void addFrame(const mrpt::obs::CObservation& observation, mrpt::obs::CObservation* own);
  bool processNext(bool flush);
  void addToOdometry(const std::vector<SensorFrame>& frames);
  void processFrames(std::vector<SensorFrame> frames);
  bool isOutput(Stamp stamp);
  void processFrame(std::size_t sensor, SensorFrame& frame);
  EgoState egoAt(Stamp stamp);
  /// `share`: what weather has left of the sensor's P_D.
  void filter(std::size_t sensor, MeasurementScan& scan, double share);
  void addToGrid(const SensorFrame& frame, const PlacedReturns& returns);
  void addToGridLater(SensorFrame frame, std::shared_ptr<const PlacedReturns> returns);
  void addOutput(const EgoState& ego, std::int64_t frame);
  void findPath(OutputSchedule::Instant& instant);
  void putOutput(OutputSchedule::Instant instant);
  void tellOf(const OutputSchedule::Instant& instant);
  Scene sceneOf(const EgoState& ego, std::int64_t frame);
  void putScene(Scene scene, const OutputSchedule::Instant& instant);
  void catchUp(std::size_t most = 0);
  void makeScenes(std::optional<Stamp> now);
  void restartTracks();

  PipelineSetup setup_;
  EventLog& events_;
  RunTiming& timing_;
  CRbpfTracker tracker_;
  SceneFromPosterior scenes_;
  EgoTimeline ego_;
  FrameQueue queue_;
  std::deque<std::vector<SensorFrame>> waiting_;  ///< for the first motion; instant by instant
  FrameNumbers frame_numbers_;
  SensorWatch watch_;
  InputWatch inputs_;
  SensorHealth health_;
  WeatherWatch weather_;
  ConditionWatch conditions_;
  WakeWatch wakes_;
  InnovationWatch innovations_;
  PhantomLedger ledger_;
  ScanMaker scan_maker_;
  std::optional<SafetyMonitor> safety_;  ///< empty: [grid] enabled = false
  OutputSchedule outputs_;
  std::deque<Scene> ready_;
  std::optional<Stamp> first_stamp_;
  Stamp last_stamp_;
  std::vector<PipelineObserver*> observers_;
  std::uint64_t made_ = 0;
  bool grid_lags_ = false;
  std::deque<LateScene> late_;
  WorkBehind grid_work_;                   ///< on safety_ and the instants of late_
  std::deque<std::size_t> scans_in_work_;  ///< numbers of the work that adds them to the grid
};

}  // namespace perception
