#pragma once
#include <memory>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/scene/RunTiming.h"

namespace perception {

/// Frames to scans: ground plane and trust in returns first, then the sensor's front end, and what
/// one sensor found for the others: ground plane and occlusion.
class ScanMaker {
 public:
  ScanMaker(const PipelineSetup& setup, RunTiming& timing);

  /// Takes the frame's ground plane where the sensor gives it, and enters the newest one into the
  /// frame.
  void addGround(std::size_t sensor, SensorFrame& frame);
  /// After addGround(). Of sensors in use.
  MeasurementScan measure(std::size_t sensor, SensorFrame& frame);
  /// The world frame is another one.
  void forgetOcclusion() { occlusion_.reset(); }

 private:
  struct Lidar {
    std::unique_ptr<GroundEstimator> ground;  ///< null: not of this sensor
    std::unique_ptr<PointFilter> weather;     ///< null: every return is trusted
  };

  const PipelineSetup& setup_;
  RunTiming& timing_;
  std::vector<Lidar> lidars_;  ///< as setup_.sensors
  GroundPlane ground_;         ///< newest, ego frame
  std::shared_ptr<const OcclusionMap> occlusion_;
  Stamp occlusion_stamp_;
};

}  // namespace perception
