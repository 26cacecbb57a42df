#pragma once
#include <mrpt/obs/CObservation.h>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"
#include "libperception/grid/GridParams.h"
#include "libperception/lidar/GroundPlane.h"
#include "libperception/measurement/DetectionModel.h"
#include "libperception/measurement/FrontEnd.h"
#include "libperception/pipeline/FrameQueue.h"
#include "libperception/scene/EventLog.h"
#include "libperception/scene/RunRecord.h"
#include "libperception/scene/RunTiming.h"
#include "libperception/scene/SceneFromPosterior.h"
#include "libperception/sensors/EgoPose.h"
#include "libperception/sensors/FromObservation.h"
#include "libperception/sensors/ScanMerge.h"
#include "libperception/weather/PointFilter.h"

namespace perception {

/// [run]: what is run on a log, and when scenes are output.
struct RunParams {
  unsigned long long seed = 1;
  std::string sensors = "C+L+R";     ///< modalities in use: letters joined by +
  std::vector<std::string> without;  ///< labels of sensors that are left out all the same
  Proposal association = Proposal::kSampled;
  std::string
      output_sensor;  ///< scenes at its scans; empty: the first lidar in use, else the first sensor
  double output_rate = 0;  ///< [Hz] instead: scenes at a fixed rate; 0 = at scans
  double output_lag =
      0;  ///< [s] scenes come so late, smoothed by what was seen meanwhile; 0: at once
  double reorder_window = 0.2;      ///< [s] how late an observation may come (method.md 1.2)
  double sensor_timeout = 1;        ///< [s] of silence after which a sensor counts as lost
  double clock_jump = 5;            ///< [s] back: a new epoch; forward: a gap worth an event
  bool write_measurements = false;  ///< what the front ends found goes into the results, too

  static const std::vector<std::string>& associationNames();  ///< in the order of Proposal
  void visit(ParamVisitor& v);
};

/// All that a run reads from its INI.
struct PipelineSetup {
  /// One [sensor.LABEL].
  struct Sensor {
    std::string label;
    DetectionParams params;
    ScanParams scan;  ///< lidars
    std::shared_ptr<const FrontEnd> front_end;
    bool active = false;  ///< its modality is in use
  };
  RunParams run;
  FilterModel model;
  ParticleFilterParams particles;
  SceneParams scene;
  EgoPoseParams ego;
  GroundParams ground;
  WeatherParams weather;
  GridParams grid;              ///< of the safety grid in pictures
  std::vector<Sensor> sensors;  ///< in the order of the INI

  /// Reads every section; faults go to the configuration (throw them with Config::finish()).
  static PipelineSetup read(Config& config);
};

/// Sees what passes through a pipeline, in order: to record it or to play it again.
class PipelineObserver {
 public:
  virtual ~PipelineObserver() = default;
  virtual void onScan(const MeasurementScan& scan) { (void)scan; }  ///< goes into the filter
  /// A scene is taken for this instant.
  virtual void onScene(const EgoState& ego, std::int64_t frame) { (void)ego, (void)frame; }
  virtual void onRestart() {}  ///< all tracks are forgotten
};

/// From observations to scenes: the one place where sensors, front ends, filter and scene meet.
/// Feed a log's observations with add(), take scenes with next() until it gives none, and at the
/// end of the log again with `flush`.
class Pipeline {
 public:
  Pipeline(PipelineSetup setup, EventLog& events, RunTiming& timing);

  void add(const mrpt::obs::CObservation& observation);
  std::optional<Scene> next(bool flush = false);
  /// Reports what is only known at the end: sensors that never spoke, labels that nobody asked for.
  void finish();
  /// To be told from now on; null: nobody.
  void observe(PipelineObserver* observer) { observer_ = observer; }

  const CRbpfTracker& tracker() const { return tracker_; }
  const PipelineSetup& setup() const { return setup_; }
  std::optional<Stamp> firstStamp() const { return first_stamp_; }  ///< of the log; t = 0
  Stamp lastStamp() const { return last_stamp_; }
  std::vector<SensorRecord> sensorRecords() const;
  std::uint64_t objects() const { return scenes_.objectsSoFar(); }

 private:
  struct SensorState {
    SensorRecord record;
    std::optional<Stamp> last;
    bool lost = false;
    bool points_reported = false;             ///< that returns were dropped
    std::unique_ptr<GroundEstimator> ground;  ///< lidars only
    std::unique_ptr<PointFilter> weather;     ///< lidars only; empty: every return is trusted
  };

  void addTime(Stamp stamp);
  void addFrame(const mrpt::obs::CObservation& observation);
  int sensorIndex(const std::string& label) const;
  void mergeScans(std::vector<SensorFrame>& frames);
  void processInstant(std::vector<SensorFrame> frames);
  EgoState egoAt(Stamp stamp);
  void restartAfterBlindGap(Stamp stamp);
  void restartTracks();
  std::int64_t frameNumberAt(Stamp stamp) const;
  std::optional<MeasurementScan> measure(SensorFrame& frame, std::size_t sensor);
  void update(const MeasurementScan& scan);
  void watchSensors(Stamp now);
  void emit(const EgoState& ego, std::int64_t frame);
  void makeScenes(std::optional<Stamp> now);
  void emitUntil(Stamp stamp);
  void startEpoch(Stamp stamp, double back);

  PipelineSetup setup_;
  EventLog& events_;
  RunTiming& timing_;
  CRbpfTracker tracker_;
  SceneFromPosterior scenes_;
  EgoPose ego_;
  FrameQueue queue_;
  std::vector<SensorState> states_;  ///< as setup_.sensors
  std::deque<std::pair<EgoState, std::int64_t>>
      pending_outputs_;  ///< instants whose scene is still to come
  std::deque<Scene> ready_;
  std::deque<std::pair<Stamp, std::int64_t>> frame_numbers_;  ///< recent
  std::map<std::string, std::uint64_t> ignored_;  ///< frames by label that no section asks for
  GroundPlane ground_;                            ///< newest, ego frame
  std::shared_ptr<const OcclusionMap> occlusion_;
  Stamp occlusion_stamp_;
  std::size_t output_sensor_ = 0;
  std::optional<Stamp> first_stamp_, next_output_, last_instant_;
  Stamp last_stamp_;
  bool parked_said_ = false, ego_gap_ = false;
  PipelineObserver* observer_ = nullptr;
  std::uint64_t frame_epoch_ = 0;  ///< EgoPose::frameEpoch() that the tracks live in
};

}  // namespace perception
