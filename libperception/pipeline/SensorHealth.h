#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/filter/state/Track.h"
#include "libperception/measurement/ClutterMap.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/SensorDoubt.h"
#include "libperception/scene/EventLog.h"

namespace perception {

/// Directions below a lidar in which the road lies, 1 deg apart: those that never return although
/// their neighbors do are dirt on its window (method.md 9.9).
class WindowDirt {
 public:
  void add(const LidarCloud& cloud, Stamp stamp);
  /// [0, 1] share of the directions without a return in the last second, between others that have
  /// some; empty while less than that is known.
  std::optional<double> share() const;

 private:
  static constexpr std::size_t kColumns = 360, kRows = 12;
  std::optional<Stamp> first_;
  Stamp last_;
  std::size_t scans_ = 0;
  std::array<std::int64_t, kColumns * kRows> seen_{};  ///< [ns] of the last return; 0: never
};

/// Sensors that deliver frames but see nothing, badly, or at a wrong place: events sensor_blind,
/// sensor_fouled, sensor_misaligned and sensor_back, with what the others still cover. Indices
/// refer to `sensors`, which must outlive this. Tracks do not depend on it.
class SensorHealth {
 public:
  SensorHealth(const std::vector<PipelineSetup::Sensor>& sensors, EventLog& events);

  /// A frame of a sensor in use, in order of time. In fog (`fog`: its probability) the road is lost
  /// in many directions, and windows are not judged.
  void addFrame(std::size_t sensor, const SensorFrame& frame, double fog);
  /// The scan of that frame and the tracks after it; `clutter`: of this sensor;
  /// `seen_share`: what weather has left of P_D in the scan's model.
  void addScan(std::size_t sensor, const MeasurementScan& scan, const Hypothesis& tracks,
               const FilterModel& model, const std::shared_ptr<const ClutterMap>& clutter,
               double seen_share = 1);
  /// SensorDoubt::seenShare()
  double seenShare(std::size_t sensor) const { return states_[sensor].doubt.seenShare(); }
  /// After a clock jump: forgets what was seen.
  void restart();

 private:
  enum class Fault { kNone, kBlind, kFouled, kMisaligned };
  struct State {
    std::optional<double> yaw;         ///< [rad] of its forward axis, ego frame; empty: not known
    std::optional<Stamp> empty_since;  ///< of the frames without anything up to now
    std::size_t empty_frames = 0;
    double usual = 0;  ///< returns of a lidar's scan, mean of the last seconds
    std::optional<Stamp> dirty_since;
    WindowDirt dirt;
    SensorDoubt doubt;
    Fault fault = Fault::kNone;
  };
  bool isEmpty(const SensorFrame& frame, State& state) const;
  void judgeWindow(std::size_t sensor, const LidarCloud& cloud, Stamp stamp);
  void judgeBlindLidar(std::size_t sensor, Stamp stamp);
  void judge(std::size_t sensor, Stamp stamp);
  /// [deg] around the vehicle that sensors of a modality see, the blind ones left out.
  double coverage(Modality modality) const;
  void report(std::size_t sensor, Stamp stamp, Fault fault, const std::string& why);

  const std::vector<PipelineSetup::Sensor>& sensors_;
  EventLog& events_;
  std::vector<State> states_;
};

}  // namespace perception
