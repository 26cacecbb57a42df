#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// The returns of one radar unit at one instant: range, bearing, range rate, amplitude. No MRPT
/// class holds range rates.
class CObservationRadarScan : public mrpt::obs::CObservation {
  DEFINE_SERIALIZABLE(CObservationRadarScan, perception)
 public:
  RadarReturns scan;
  mrpt::poses::CPose3D sensor_pose;  ///< in the vehicle frame; x forward, y left, z up

  void getSensorPose(mrpt::poses::CPose3D& pose) const override { pose = sensor_pose; }
  void setSensorPose(const mrpt::poses::CPose3D& pose) override { sensor_pose = pose; }
  void getDescriptionAsText(std::ostream& out) const override;
  bool exportTxtSupported() const override { return true; }
  std::string exportTxtHeader() const override;
  std::string exportTxtDataRow() const override;
};

}  // namespace perception
