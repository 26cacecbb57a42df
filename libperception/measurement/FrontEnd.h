#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/measurement/Measurement.h"

namespace perception {

/// A front end: turns one sensor's frame into measurements. Const and without state, so front ends
/// may run in parallel.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  /// The scan of a frame: who saw it, when, from where, under which model, and what fill() adds.
  MeasurementScan extract(const SensorFrame& frame) const;
  /// Names of what Measurement::label indexes; empty: no labels.
  virtual std::vector<std::string> labelNames() const { return {}; }

 protected:
  virtual Modality modality() const = 0;
  virtual std::shared_ptr<const MeasurementModel> model() const = 0;
  /// The pose in which the model measures; cameras and radars take pitch and roll out of it.
  virtual Pose3 measuringPose(const SensorFrame& frame) const { return frame.T_world_sensor(); }
  /// Adds measurements and occlusion. `frame.data` should hold the kind of data that this front end
  /// reads, else nothing is added; bad points and boxes are dropped and counted.
  virtual void fill(const SensorFrame& frame, MeasurementScan& scan) const = 0;
};

}  // namespace perception
