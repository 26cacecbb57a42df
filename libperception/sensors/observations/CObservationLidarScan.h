#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// One scan of a 3D lidar with the attributes of each return that weather filters use: intensity,
/// beam, time, echo number, pulse width, the sensor's own label. No point cloud of MRPT 2.5.8 holds
/// them. Arrays are serialized as one block each; absent arrays take no space.
class CObservationLidarScan : public mrpt::obs::CObservation {
  DEFINE_SERIALIZABLE(CObservationLidarScan, perception)
 public:
  LidarCloud cloud;                  ///< points in the sensor frame
  mrpt::poses::CPose3D sensor_pose;  ///< pose of the sensor in the vehicle frame

  void getSensorPose(mrpt::poses::CPose3D& pose) const override { pose = sensor_pose; }
  void setSensorPose(const mrpt::poses::CPose3D& pose) override { sensor_pose = pose; }
  void getDescriptionAsText(std::ostream& out) const override;
  bool exportTxtSupported() const override { return true; }
  std::string exportTxtHeader() const override;
  std::string exportTxtDataRow() const override;
};

}  // namespace perception
