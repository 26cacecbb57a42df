#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/scene/EventLog.h"
#include "libperception/scene/Scene.h"

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

/// Sensors that deliver frames but see nothing, or badly: events sensor_blind, sensor_fouled and
/// sensor_back. Indices refer to `sensors`, which must outlive this. Tracks do not depend on it.
class SensorHealth {
 public:
  SensorHealth(const std::vector<PipelineSetup::Sensor>& sensors, EventLog& events);

  /// A frame of a sensor in use, in order of time. In fog (`fog`: its probability) the road is lost
  /// in many directions, and windows are not judged.
  void addFrame(std::size_t sensor, const SensorFrame& frame, double fog);
  /// Road users that some sensors see, others should see, too.
  void addScene(const Scene& scene, const ClassTable& classes);
  /// After a clock jump: forgets what was seen.
  void restart();

 private:
  enum class Fault { kNone, kBlind, kFouled };
  struct State {
    Pose3 T_ego_sensor = Pose3::Identity();
    std::optional<Stamp> empty_since;  ///< of the frames without anything up to now
    std::size_t empty_frames = 0;
    double witnessed = 0;  ///< [s] since then: times of objects in its view that others see
    double usual = 0;      ///< returns of a lidar's scan, mean of the last seconds
    std::optional<Stamp> dirty_since;
    WindowDirt dirt;
    Fault fault = Fault::kNone;
  };
  bool isEmpty(const SensorFrame& frame, State& state) const;
  void judgeWindow(std::size_t sensor, const LidarCloud& cloud, Stamp stamp);
  bool shouldSee(std::size_t sensor, const SceneObject& object, const Scene& scene) const;
  void judgeBlind(std::size_t sensor, Stamp stamp);
  void report(std::size_t sensor, Stamp stamp, Fault fault, const std::string& why);

  const std::vector<PipelineSetup::Sensor>& sensors_;
  EventLog& events_;
  std::vector<State> states_;
  std::optional<Stamp> last_scene_;
};

}  // namespace perception
