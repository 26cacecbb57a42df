#pragma once
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A satellite receiver: [sensor.LABEL] kind = gnss. Noise of a plain receiver (assumed, as
/// GnssParams).
struct GnssUnitParams {
  double sigma = 1.5;           ///< [m] east and north each, white noise of each fix
  double height_sigma = 3;      ///< [m]
  double velocity_sigma = 0.1;  ///< [m/s] east and north each (Doppler)
  bool velocity = true;         ///< RMC with speed and course beside GGA
  double delay = 0;             ///< [s] latency of a fix in the log; its stamp is the true one
  std::vector<double> gap_from, gap_to;  ///< [s] intervals without satellites
  double latitude = 42.4440;             ///< [deg] of the world's origin (Ithaca, New York)
  double longitude = -76.5019;           ///< [deg]
  double height = 250;                   ///< [m] above the ellipsoid

  void visit(ParamVisitor& v);
};

/// Three gyros and three accelerometers: [sensor.LABEL] kind = imu. Biases are drawn once per log.
/// Values typical of MEMS data sheets, assumed (method.md 1.4).
struct ImuUnitParams {
  double gyro_noise = radians(0.05);  ///< [rad/sqrt(s)] angle random walk
  double gyro_bias = radians(0.5);    ///< [rad/s] standard deviation of the bias of each axis
  double accel_noise = 0.05;          ///< [m/s^2 sqrt(s)] velocity random walk
  double accel_bias = 0.1;            ///< [m/s^2] standard deviation of the bias of each axis
  double vibration = 0.3;             ///< [m/s^2] of engine and road, lateral and vertical

  void visit(ParamVisitor& v);
};

/// The speed of the rear axle: [sensor.LABEL] kind = wheels. The scale error is drawn once per log.
/// Assumed.
struct WheelUnitParams {
  double sigma = 0.05;  ///< [m/s] of one reading
  double scale = 0.02;  ///< [-] standard deviation of the scale error: tires, pressure
  double yaw_rate_sigma = radians(0.5);  ///< [rad/s] from the speed difference of the wheels

  void visit(ParamVisitor& v);
};

/// Mounting pose and rate of an ego-motion sensor.
struct EgoMount {
  std::string label;
  Pose3 T_ego_sensor = Pose3::Identity();
  double rate = 10;  ///< [1/s]
};

/// True ego motion as a function of t [s] since the log's first stamp.
struct EgoTruth {
  std::function<EgoState(double)> at;  ///< pose, velocity and yaw rate
  std::function<Stamp(double)> stamp;
};

/// Readings at t [s]; `key`: random stream of the sensor (purpose) and reading (counter).
/// CObservationGPS with GGA and RMC; null in a gap.
std::shared_ptr<mrpt::obs::CObservation> gnssObservation(const GnssUnitParams& params,
                                                         const EgoMount& mount,
                                                         const EgoTruth& truth, double t,
                                                         const RngKey& key);
/// CObservationIMU with mean angular rate and specific force since the previous reading.
std::shared_ptr<mrpt::obs::CObservation> imuObservation(const ImuUnitParams& params,
                                                        const EgoMount& mount,
                                                        const EgoTruth& truth, double t,
                                                        const RngKey& key);
/// CObservationOdometry with velocities alone.
std::shared_ptr<mrpt::obs::CObservation> wheelObservation(const WheelUnitParams& params,
                                                          const EgoMount& mount,
                                                          const EgoTruth& truth, double t,
                                                          const RngKey& key);

}  // namespace perception
