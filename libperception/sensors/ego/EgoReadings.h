#pragma once
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// A reading of an inertial unit, in the vehicle's axes and reduced to its rear axle.
struct ImuReading {
  bool gyro = false, accelerometer = false;
  Vector3 rates = Vector3::Zero();  ///< [rad/s]
  Vector3 force = Vector3::Zero();  ///< [m/s^2] specific force: at rest g upward
};

/// A reading of wheel odometry.
struct WheelReading {
  double speed = 0;                ///< [m/s] > 0 forward
  std::optional<double> yaw_rate;  ///< [rad/s] from wheel differences or the steering
};

/// One reading of any ego motion sensor; readings of one instant are processed in this order.
using EgoReading = std::variant<ImuReading, WheelReading, GnssFix>;

/// Empty when the observation has neither rates nor forces, or values that are not finite. A yaw
/// gyro alone suffices; an accelerometer needs three axes.
std::optional<ImuReading> imuReading(const mrpt::obs::CObservationIMU& imu);

/// Wheel readings of several odometers, by their velocities or by differences of their poses.
class Odometers {
 public:
  /// Empty for a first pose, one out of order or after a long gap, and for values that are not
  /// finite.
  std::optional<WheelReading> read(const mrpt::obs::CObservationOdometry& odometry, Stamp stamp);

 private:
  std::map<std::string, std::pair<Stamp, mrpt::poses::CPose2D>> last_;  ///< by label
};

}  // namespace perception
