#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// The objects found by an external detector at one instant: image boxes, 3D boxes, or both, with
/// scores. No MRPT class holds labeled boxes.
class CObservationObjectDetections : public mrpt::obs::CObservation {
  DEFINE_SERIALIZABLE(CObservationObjectDetections, perception)
 public:
  ObjectDetections detections;
  /// In the vehicle frame: pose of the sensor frame of the 3D boxes (x forward, y left, z up); with
  /// image boxes only, of the camera's optical frame (x right, y down, z forward).
  mrpt::poses::CPose3D sensor_pose;

  void getSensorPose(mrpt::poses::CPose3D& pose) const override { pose = sensor_pose; }
  void setSensorPose(const mrpt::poses::CPose3D& pose) override { sensor_pose = pose; }
  void getDescriptionAsText(std::ostream& out) const override;
  bool exportTxtSupported() const override { return true; }
  std::string exportTxtHeader() const override;
  std::string exportTxtDataRow() const override;
};

}  // namespace perception
