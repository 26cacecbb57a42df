#pragma once
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A point of an object's outline as seen from the sensor.
struct OutlinePoint {
  double direction = 0;  ///< [rad] world yaw of the line of sight
  double range = 1;      ///< [m] horizontal
};

/// What an uncertain vehicle pose adds to R of (bearing of the left edge, bearing of the right
/// edge, range of the nearest point): J P J' by the sensor's x, y and yaw (method.md 1.3). A turned
/// vehicle sees both edges wrong alike, hence the whole matrix [rad, rad, m]. Pitch is left to
/// sensors whose range depends on it.
Eigen::Matrix3d poseNoise(const OutlinePoint& left, const OutlinePoint& right,
                          const OutlinePoint& nearest, const PoseUncertainty& pose);

}  // namespace perception
