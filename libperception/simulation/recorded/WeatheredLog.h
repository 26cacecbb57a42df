#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/recorded/BeamPattern.h"
#include "libperception/simulation/world/World.h"

namespace perception {

/// Simulated weather on a recording, observation by observation: lidar returns, radar targets,
/// boxes of image detectors and images as the same sensors would have given them in that weather.
/// Everything else is kept as it is. How far away is what an image shows, the lidars' last scans
/// before it tell. Images that cannot be read, or of cameras without a calibration, are left out.
/// A function of recording, weather and seed.
class WeatheredLog {
 public:
  /// `scene` with its `weather`, as of recordedScene(); `first`: stamp of the log; `threads` 0 =
  /// number of cores; `images`: folder of external images (imagesBeside()).
  WeatheredLog(Scenario scene, Stamp first, std::uint64_t seed, int threads = 1,
               std::string images = "");
  ~WeatheredLog();

  struct Counts {
    std::uint64_t scans = 0, returns = 0, lost = 0, phantoms = 0;  ///< of lidars
    std::uint64_t targets = 0, targets_lost = 0;                   ///< of radars
    std::uint64_t boxes = 0, boxes_lost = 0;                       ///< of image detectors
    std::uint64_t images = 0, images_left_out = 0;
  };

  /// The observation in this weather; null: left out. Observations must come in order of the log.
  std::shared_ptr<mrpt::obs::CObservation> apply(
      const std::shared_ptr<mrpt::obs::CObservation>& observation);
  /// Of the last observation, where it was a lidar scan: what each return is, as labelOf(Phantom).
  const std::optional<std::vector<std::uint32_t>>& labels() const { return labels_; }
  std::int64_t frame() const { return frame_; }  ///< the log's number of the last one; -1: none
  const Counts& counts() const { return counts_; }
  /// For the log's first comment.
  std::string text() const;

 private:
  /// False: it is left out.
  bool alterImage(const SensorParams& sensor, double t, const RngKey& key, SensorFrame& frame);
  void alterScan(const SensorParams& sensor, double t, const RngKey& key, SensorFrame& frame);
  void alterReturns(const SensorParams& sensor, const RngKey& key, RadarReturns& radar,
                    const Pose3& T_world_sensor);
  void alterBoxes(const SensorParams& sensor, const RngKey& key, ObjectDetections& detections,
                  const Pose3& T_world_camera);

  World world_;
  LidarCaster caster_;
  Stamp first_;
  std::uint64_t seed_;
  std::unique_ptr<SimulatedWeather> weather_;
  std::string images_;
  std::map<std::string, std::vector<Vector3>> returns_;  // [m] world, of each lidar's last scan
  std::map<std::string, BeamPattern> patterns_;          // by lidar
  std::map<std::string, std::uint64_t> frames_of_;       // frames so far, by sensor
  std::int64_t frame_ = -1;
  std::optional<std::vector<std::uint32_t>> labels_;
  Counts counts_;
};

}  // namespace perception
