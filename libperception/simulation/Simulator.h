#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/core/math/Random.h"
#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"

namespace perception {

/// First words of the comment that is the first observation of a simulated log. Comments are
/// identified by text because MRPT does not store their label.
inline constexpr const char* kSimulatedText = "simulated log: ";

/// Simulates a scenario as a sequence of observations: a comment that marks the log as simulated,
/// then in chronological order ego poses, frame numbers and sensor observations. Deterministic in
/// scenario and seed.
class Simulator {
 public:
  /// `name` of the scenario goes into the first comment; `threads` 0 = number of cores.
  Simulator(Scenario scenario, const std::string& name, std::uint64_t seed, int threads = 1);

  /// Weather from now on; default: that of the scenario.
  void setWeather(std::unique_ptr<SimulatedWeather> weather) { weather_ = std::move(weather); }

  /// The next observation; null at the end.
  std::shared_ptr<mrpt::obs::CObservation> next();

  /// Truth of all completed frames.
  const std::vector<TruthObject>& truth() const { return truth_; }

  /// Classes of the returns of the scan that next() gave (PointTruth.h), in weather; else nothing.
  std::optional<std::vector<std::uint32_t>> takeLabels() {
    return std::exchange(labels_, std::nullopt);
  }

  double time() const { return next_ > 0 ? events_[next_ - 1].t : 0; }  ///< [s] of the last one
  std::int64_t frames() const { return frames_; }
  std::uint64_t scans() const { return scans_; }          ///< of lidars
  std::uint64_t points() const { return points_; }        ///< of lidars
  std::uint64_t beams() const { return beams_; }          ///< cast by lidars
  std::uint64_t boxes() const { return boxes_; }          ///< of detectors
  std::uint64_t images() const { return images_; }        ///< of cameras
  std::uint64_t targets() const { return targets_; }      ///< of radars
  std::uint64_t unwritten() const { return unwritten_; }  ///< frames without an observation class
  const World& world() const { return world_; }

 private:
  /// A scheduled event. The order of the kinds is the order at equal times.
  struct Event {
    enum Kind { kComment, kPose, kFrame, kSensor } kind;
    double t;             // [s]
    std::int64_t ticks;   // 100 ns: the order
    std::size_t sensor;   // kSensor
    std::uint64_t count;  // number of earlier events of this kind (and sensor)
  };
  void schedule(Event::Kind kind, std::size_t sensor, double rate, double phase);
  void beginFrame(const Event& event);
  void endFrame();
  std::shared_ptr<mrpt::obs::CObservation> play(const Event& event);
  EgoState reportedEgo(double t);
  std::shared_ptr<mrpt::obs::CObservation> sense(const Event& event);
  LidarCloud scanLidar(const Event& event, const RngKey& key);
  ObjectDetections seeObjects(const Event& event, const Pose3& T_world_camera, const RngKey& key);
  std::shared_ptr<mrpt::obs::CObservation> feelEgo(const Event& event);
  CameraImage takeImage(const Event& event, const Pose3& T_world_camera, const RngKey& key) const;
  RadarReturns listenRadar(const Event& event, const RngKey& key);

  World world_;
  LidarCaster caster_;
  std::unique_ptr<SimulatedWeather> weather_;
  std::string name_;
  std::uint64_t seed_;
  std::vector<LidarSensor> lidars_;  // one a sensor; cameras have an idle one
  std::vector<Event> events_;
  std::size_t next_ = 0;
  std::vector<TruthObject> open_, truth_;    // rows of the frame being played, of all before
  std::vector<std::vector<int>> points_on_;  // [sensor][object] of the sensor's last scan
  std::vector<bool> scanned_;                // [sensor] since the frame began
  std::optional<std::vector<std::uint32_t>> labels_;
  Rng pose_rng_;
  Vector3 pose_error_ = Vector3::Zero();  // x, y [m], yaw [rad] of the reported pose
  double pose_error_time_ = 0;            // [s]
  bool pose_error_drawn_ = false;
  std::int64_t frames_ = 0;
  std::uint64_t scans_ = 0, points_ = 0, beams_ = 0, boxes_ = 0, images_ = 0, targets_ = 0,
                unwritten_ = 0;
};

}  // namespace perception
