#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/phantoms/PhantomLedger.h"
#include "libperception/pipeline/phantoms/WeatherWatch.h"
#include "libperception/scene/files/RunTiming.h"

namespace perception {

/// Converts frames to scans: ground plane, trust of lidar returns, then the sensor's front end.
/// Passes ground plane and occlusion map of one sensor to the others.
class ScanMaker {
 public:
  ScanMaker(const PipelineSetup& setup, RunTiming& timing, WeatherWatch& weather,
            PhantomLedger& ledger);

  /// Updates the ground plane if the sensor gives it, and sets the newest one in the frame.
  void addGround(std::size_t sensor, SensorFrame& frame);
  /// For sensors in use, after addGround().
  MeasurementScan measure(std::size_t sensor, SensorFrame& frame);
  /// Call when the world frame changes.
  void restart();
  /// What the preparations of frames have learned: INI lines, section by section.
  std::vector<std::string> learned() const;

 private:
  /// Empty: its returns are not weighed.
  std::optional<TrustStats> weighReturns(std::size_t sensor, SensorFrame& frame);
  void addToLedger(std::size_t sensor, const SensorFrame& frame, const TrustStats& trust,
                   const MeasurementScan& scan);
  struct Stages {
    std::unique_ptr<GroundEstimator> ground;  ///< null: this sensor does not give the ground plane
    std::unique_ptr<PointFilter> weather;     ///< null: trust 1 for every return
    std::unique_ptr<FramePreparation> preparation;  ///< null: none
    std::shared_ptr<const EarlierScan> before;      ///< of a lidar; null: none
  };

  const PipelineSetup& setup_;
  RunTiming& timing_;
  WeatherWatch& weather_;
  PhantomLedger& ledger_;
  std::vector<Stages> stages_;  ///< index as in setup_.sensors
  GroundPlane ground_;          ///< newest, ego frame
  std::shared_ptr<const OcclusionMap> occlusion_;
  Stamp occlusion_stamp_;
};

}  // namespace perception
