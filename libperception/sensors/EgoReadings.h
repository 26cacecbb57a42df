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
#include "libperception/sensors/GnssFix.h"

namespace perception {

/// What an inertial unit felt, about the vehicle's axes and at its rear axle.
struct ImuReading {
  bool gyro = false, accelerometer = false;
  Vector3 rates = Vector3::Zero();  ///< [rad/s]
  Vector3 force = Vector3::Zero();  ///< [m/s^2] specific force: at rest gravity, upwards
};

/// How fast the wheels turned.
struct WheelReading {
  double speed = 0;                ///< [m/s] > 0 forward
  std::optional<double> yaw_rate;  ///< [rad/s] from their difference or the steering
};

/// One reading of any of the vehicle's own sensors; the order is that of one instant.
using EgoReading = std::variant<ImuReading, WheelReading, GnssFix>;

/// Empty when the unit holds neither rates nor forces, or numbers that are none. A gyro of the yaw
/// axis alone is a gyro; an accelerometer has three axes.
std::optional<ImuReading> imuReading(const mrpt::obs::CObservationIMU& imu);

/// Wheel readings of several odometers: their velocities, or the differences of their sums.
class Odometers {
 public:
  /// Empty for a first sum, one out of order or after a long gap, and for numbers that are none.
  std::optional<WheelReading> read(const mrpt::obs::CObservationOdometry& odometry, Stamp stamp);

 private:
  std::map<std::string, std::pair<Stamp, mrpt::poses::CPose2D>> last_;  ///< by label
};

}  // namespace perception
