#pragma once
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Angle.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// Parameters of EgoFusion, part of [ego]. Noise figures of MEMS data sheets and usual wheels,
/// assumed (method.md 1.4).
struct FusionParams {
  GnssParams gnss;
  std::string gnss_label, imu_label, wheels_label;  ///< empty: all of that kind
  double gyro_noise = radians(0.05);       ///< [rad/sqrt(s)] angle random walk (MEMS data sheets)
  double gyro_bias_sigma = radians(0.5);   ///< [rad/s] at the start
  double gyro_bias_walk = radians(0.002);  ///< [rad/s/sqrt(s)]
  double accel_noise = 0.05;               ///< [m/s^2 sqrt(s)] velocity random walk
  double accel_bias_sigma = 0.1;           ///< [m/s^2] at the start
  double accel_bias_walk = 0.002;          ///< [m/s^2/sqrt(s)]
  double wheel_sigma = 0.05;               ///< [m/s] of one reading
  double wheel_scale_sigma = 0.02;         ///< [-] tire size, pressure
  double slip = 0.02;                      ///< [m/sqrt(s)] motion not explained by wheels and model
  double level_sigma = 0.3;                ///< [m/s^2] lateral force besides turning and gravity
  double heading_wait = 5;     ///< [s] for a heading, after which the start frame is kept
  double late = 1;             ///< [s] largest delay of an observation
  std::vector<double> origin;  ///< [deg, deg, m] of the world frame; empty: the first fix

  void visit(ParamVisitor& v);
};

}  // namespace perception
