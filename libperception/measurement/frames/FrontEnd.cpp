#include "libperception/measurement/frames/FrontEnd.h"

namespace perception {

MeasurementScan FrontEnd::extract(const SensorFrame& frame) const {
  MeasurementScan scan;
  scan.sensor = frame.sensor;
  scan.modality = modality();
  scan.frame = frame.frame;
  scan.state = {frame.stamp, measuringPose(frame), frame.ego};
  scan.model = model();
  fill(frame, scan);
  if (noise_scale_ != 1)
    for (Measurement& m : scan.measurements) scaleNoise(m, noise_scale_);
  return scan;
}

}  // namespace perception
