#include "libperception/sensors/ego/EgoReadings.h"

#include <cmath>

#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace {

constexpr double kLongestDifference = 1;  // [s] between two poses of an odometer
constexpr double kMaxSpeed = 200;         // [m/s]

}  // namespace

std::optional<ImuReading> imuReading(const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;
  ImuReading reading;
  reading.gyro = imu.has(IMU_WZ);
  reading.accelerometer = imu.has(IMU_X_ACC) && imu.has(IMU_Y_ACC) && imu.has(IMU_Z_ACC);
  const Pose3 T_ego_imu = toPose3(imu.sensorPose);
  const auto vector = [&](TIMUDataIndex x, TIMUDataIndex y, TIMUDataIndex z) -> Vector3 {
    const auto value = [&](TIMUDataIndex i) { return imu.has(i) ? imu.rawMeasurements[i] : 0; };
    return T_ego_imu.linear() * Vector3(value(x), value(y), value(z));
  };
  if (reading.gyro) reading.rates = vector(IMU_WX, IMU_WY, IMU_WZ);
  if (reading.accelerometer) reading.force = vector(IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC);
  if (!reading.gyro && !reading.accelerometer) return {};
  if (!reading.rates.allFinite() || !reading.force.allFinite()) return {};
  // Removes the acceleration of the lever arm by rotation.
  const Vector3& w = reading.rates;
  if (reading.accelerometer) reading.force -= w.cross(w.cross(T_ego_imu.translation()));
  return reading;
}

std::optional<WheelReading> Odometers::read(const mrpt::obs::CObservationOdometry& odometry,
                                            Stamp stamp) {
  WheelReading reading;
  if (odometry.hasVelocities) {
    reading.speed = odometry.velocityLocal.vx;
    reading.yaw_rate = odometry.velocityLocal.omega;
  } else {
    const auto known = last_.find(odometry.sensorLabel);
    const bool first = known == last_.end();
    if (!first && stamp <= known->second.first) return {};
    const auto before = first ? std::make_pair(stamp, odometry.odometry) : known->second;
    last_[odometry.sensorLabel] = {stamp, odometry.odometry};
    const double dt = stamp - before.first;
    if (first || dt > kLongestDifference) return {};
    const auto step = odometry.odometry - before.second;
    reading.speed = step.x() / dt;
    reading.yaw_rate = wrapAngle(step.phi()) / dt;
  }
  if (!std::isfinite(reading.speed + *reading.yaw_rate)) return {};
  if (std::abs(reading.speed) > kMaxSpeed) return {};
  return reading;
}

}  // namespace perception
