#pragma once
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/ClutterMap.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/health/FrozenPicture.h"
#include "libperception/pipeline/health/ReturnRate.h"
#include "libperception/pipeline/health/SensorDoubt.h"
#include "libperception/pipeline/health/WindowDirt.h"
#include "libperception/scene/files/EventLog.h"

namespace perception {

/// Sensors that deliver frames but see nothing, badly, or at a wrong place: events sensor_blind,
/// sensor_fouled, sensor_misaligned and sensor_back, with what the others still cover. Indices
/// refer to `sensors`, which must outlive this. Tracks do not depend on it.
class SensorHealth {
 public:
  SensorHealth(const std::vector<PipelineSetup::Sensor>& sensors, EventLog& events);

  /// A frame of a sensor in use, in order of time. In fog (`fog`: its probability) the road is lost
  /// in many directions, and windows are not judged.
  void addFrame(std::size_t sensor, const SensorFrame& frame, double fog);
  /// A frame of a scanner that is part of a sensor (ScanParams::merge), before it is merged.
  void addPart(std::size_t sensor, const SensorFrame& part);
  /// The scan of that frame and the tracks after it; `clutter`: of this sensor;
  /// `seen_share`: what weather has left of P_D in the scan's model.
  void addScan(std::size_t sensor, const MeasurementScan& scan, const Hypothesis& tracks,
               const FilterModel& model, const std::shared_ptr<const ClutterMap>& clutter,
               double seen_share = 1);
  const DetectionCount& count(std::size_t sensor) const { return states_[sensor].doubt.count(); }
  /// After a clock jump: forgets what was seen.
  void restart();

 private:
  enum class Fault { kNone, kBlind, kFouled, kMisaligned };
  struct State {
    std::optional<double> yaw;         ///< [rad] of its forward axis, ego frame; empty: not known
    std::optional<Stamp> empty_since;  ///< of the frames without anything up to now; no lidar
    ReturnRate returns;                ///< of a lidar
    std::map<std::string, ReturnRate> parts;  ///< of the scanners that it is merged of
    std::set<std::string> blind_parts;
    std::optional<Stamp> dirty_since;
    WindowDirt dirt;
    FrozenPicture picture;
    SensorDoubt doubt;
    Fault fault = Fault::kNone;
  };
  void judgeFrozen(std::size_t sensor, Stamp stamp);
  void judgeWindow(std::size_t sensor, const LidarCloud& cloud, Stamp stamp);
  void judgeLoss(std::size_t sensor, Stamp stamp);
  void judge(std::size_t sensor, Stamp stamp);
  /// [deg] around the vehicle that sensors of a modality see, the blind ones left out.
  double coverage(Modality modality) const;
  void report(std::size_t sensor, Stamp stamp, Fault fault, const std::string& why);
  void write(std::size_t sensor, const std::string& label, Stamp stamp, Fault fault,
             const std::string& why);

  const std::vector<PipelineSetup::Sensor>& sensors_;
  EventLog& events_;
  std::vector<State> states_;
};

}  // namespace perception
