#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/frames/FramePreparation.h"

namespace perception {

/// A front end converts one sensor frame into measurements. Stateless, so front ends may run in
/// parallel.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  /// The scan of a frame: sensor, stamp, pose, measurement model, and what fill() adds.
  MeasurementScan extract(const SensorFrame& frame) const;
  /// Multiplies the standard deviations of all measurements, [sensor.LABEL] noise_scale.
  void scaleNoiseBy(double factor) { noise_scale_ = factor; }
  /// Names of what Measurement::label indexes; empty: no labels.
  virtual std::vector<std::string> labelNames() const { return {}; }
  /// What its frames have to go through first, for one sensor of one run; null: nothing.
  virtual std::unique_ptr<FramePreparation> preparation() const { return nullptr; }

 protected:
  virtual Modality modality() const = 0;
  virtual std::shared_ptr<const MeasurementModel> model() const = 0;
  /// T_world_sensor in which z is measured; cameras and radars remove pitch and roll.
  virtual Pose3 measuringPose(const SensorFrame& frame) const { return frame.T_world_sensor(); }
  /// Adds measurements and occlusion. Adds nothing when `frame.data` is of another kind than this
  /// front end reads; invalid points and boxes are dropped and counted.
  virtual void fill(const SensorFrame& frame, MeasurementScan& scan) const = 0;

 private:
  double noise_scale_ = 1;
};

}  // namespace perception
