#pragma once
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Angle.h"
#include "libperception/sensors/GnssFix.h"

namespace perception {

/// Noise of the vehicle's own sensors and how its pose is found without poses in the log: in [ego].
/// Figures of MEMS data sheets and usual wheels, assumed (method.md 1.4).
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
  double wheel_scale_sigma = 0.02;         ///< [-] tires, pressure
  double slip = 0.02;          ///< [m/sqrt(s)] motion that neither wheels nor model explain
  double level_sigma = 0.3;    ///< [m/s^2] sideways force beside turning and gravity
  double heading_wait = 5;     ///< [s] for a heading before the start's frame is kept
  double late = 1;             ///< [s] at most an observation may come late
  std::vector<double> origin;  ///< [deg, deg, m] of the world; empty: the first fix

  void visit(ParamVisitor& v);
};

}  // namespace perception
