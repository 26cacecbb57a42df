#pragma once
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A point of an object's outline as seen from the sensor.
struct OutlinePoint {
  double direction = 0;  ///< [rad] world yaw of the line of sight
  double range = 1;      ///< [m] horizontal
};

/// The contribution of an uncertain vehicle pose to R of (bearing of the left edge, bearing of the
/// right edge, range of the nearest point): J P J' by the sensor's x, y and yaw (method.md 1.3). A
/// yaw error shifts both bearings alike, hence the full 3 x 3 matrix [rad, rad, m]. Pitch is added
/// by sensors whose range depends on it.
Eigen::Matrix3d poseNoise(const OutlinePoint& left, const OutlinePoint& right,
                          const OutlinePoint& nearest, const PoseUncertainty& pose);

}  // namespace perception
