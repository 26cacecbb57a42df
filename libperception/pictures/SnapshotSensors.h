#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "gui-offscreen/views/SceneView.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/weather/state/WeatherState.h"

namespace perception {

/// Parameters of the drawing of sensor data.
struct SnapshotSensorParams {
  GridParams grid;
  StopParams stop;
  GroundParams ground;
  WeatherParams weather;
  double memory = 5;          ///< [s] lidar scans of this time before the instant are in the grid
  bool measurements = false;  ///< of the front ends are drawn
  std::string camera;         ///< label of the displayed camera; empty: the first one with images
  /// Sensors of the site INI: returns used and measurements. Other sensors are drawn with default
  /// settings and without measurements.
  std::vector<PipelineSetup::Sensor> sensors;

  /// Sets everything that an INI says; `site`: it names sensors.
  void read(Config& config, bool site);
};

/// Sensor data of a log up to an instant, for pictures of a run: last lidar returns and safety grid
/// over the preceding seconds, last radar returns, last image, and the measurements of the front
/// ends. Ego poses are those of the run.
class SnapshotSensors {
 public:
  /// Reads the first seconds of the log for layers(). The run must outlive this; of its scenes only
  /// those of the past() seconds before an instant and the first after it are needed.
  SnapshotSensors(const std::string& log, const TrackedRun& run, SnapshotSensorParams params);

  /// Reads on to `stamp`, which must not go back.
  void advanceTo(Stamp stamp);
  /// [s] of log before an instant that count for it.
  double past() const;
  /// Adds the data of the last instant to the view, the free lane as the run's scene says, else by
  /// the grid of the past() seconds.
  void fill(SceneView& view);

  const ViewLayers& layers() const { return layers_; }
  bool hasImages() const { return images_; }                 ///< of the camera that is shown
  const SafetyGrid& grid() const { return safety_.grid(); }  ///< as of the last instant
  const RawlogReader& reader() const { return reader_; }
  std::uint64_t scans() const { return scans_; }    ///< number added to the grid so far
  std::uint64_t frames() const { return frames_; }  ///< of any sensor, within the run's time
  /// Path of the first image that could not be loaded; empty: none.
  const std::string& missingImage() const { return missing_image_; }

 private:
  /// State of one lidar from scan to scan.
  struct Lidar {
    GroundEstimator ground;
    std::unique_ptr<PointFilter> weather;
    WeatherEstimator air;
    std::vector<ViewPoint> points;  ///< of the last scan
  };
  /// Parameters for the returns of one scan.
  struct LidarSettings {
    PointParams points;
    SurfaceParams surface;
    ObstacleParams obstacles;
  };

  void lookAhead(const std::string& log);
  std::optional<SensorFrame> frameOf(const mrpt::obs::CObservation& observation) const;
  const PipelineSetup::Sensor* sensorOf(const std::string& label) const;
  LidarSettings settingsOf(const SensorFrame& frame) const;
  void take(SensorFrame frame);
  void takeLidar(SensorFrame& frame);
  void addMeasurements(const SensorFrame& frame, SceneView& view) const;
  void addImage(SceneView& view);

  std::string log_;
  RawlogReader reader_;
  const TrackedRun& run_;
  SnapshotSensorParams params_;
  ViewLayers layers_;
  bool images_ = false;
  SafetyMonitor safety_;
  std::map<std::string, Lidar> lidars_;      ///< by label
  std::map<std::string, SensorFrame> last_;  ///< last frame by label; images and boxes, too
  GroundPlane ground_;                       ///< newest, ego frame
  std::shared_ptr<mrpt::obs::CObservation> next_;
  std::uint64_t scans_ = 0, frames_ = 0;
  std::string missing_image_;
  Stamp now_;
};

}  // namespace perception
