#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// One scan of a 3D lidar with everything that weather filters want of each return: intensity,
/// beam, time, echo number, pulse width, the sensor's own label. MRPT 2.5.8 has no point cloud that
/// carries them. Float arrays are written as they are, in one block each; arrays that a sensor does
/// not have take no room.
class CObservationLidarScan : public mrpt::obs::CObservation {
  DEFINE_SERIALIZABLE(CObservationLidarScan, perception)
 public:
  LidarCloud cloud;                  ///< points in the sensor frame
  mrpt::poses::CPose3D sensor_pose;  ///< of the sensor on the vehicle

  void getSensorPose(mrpt::poses::CPose3D& pose) const override { pose = sensor_pose; }
  void setSensorPose(const mrpt::poses::CPose3D& pose) override { sensor_pose = pose; }
  void getDescriptionAsText(std::ostream& out) const override;
  bool exportTxtSupported() const override { return true; }
  std::string exportTxtHeader() const override;
  std::string exportTxtDataRow() const override;
};

}  // namespace perception
