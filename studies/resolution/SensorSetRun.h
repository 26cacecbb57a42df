#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/files/MeasurementRun.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// A pipeline that keeps what its front ends found and its scenes.
class SensorSetRun : public PipelineObserver {
 public:
  /// Reads and finishes the configuration; `name` is that of faults.
  SensorSetRun(std::string name, Config& config);

  void add(const mrpt::obs::CObservation& observation);
  /// Call at the end. Throws DataError if there is no scene.
  void finish();

  TrackedRun tracks;
  MeasurementRun measurements;

 private:
  void onScan(const MeasurementScan& scan) override;
  void take(bool flush);

  std::string name_;
  EventLog events_;
  RunTiming timing_;
  std::unique_ptr<Pipeline> pipeline_;
};

/// Its section when the sensor of this label is in use; else null.
const PipelineSetup::Sensor* sensorInUse(const PipelineSetup& site, const std::string& label);

/// A simulator's rows by instant.
GroundTruth truthByInstant(const std::vector<TruthObject>& rows);

}  // namespace perception
