#include "libperception/sensors/ego/FusionParams.h"

namespace perception {

void FusionParams::visit(ParamVisitor& v) {
  gnss.visit(v);
  v.angle("gyro_noise_deg", gyro_noise, {1e-6, 10}, "angle random walk over one second");
  v.angle("gyro_bias_sigma_deg", gyro_bias_sigma, {0, 20}, "rate of a gyro at rest, per second");
  v.real("accel_noise", accel_noise, {1e-6, 10}, "m/s", "velocity random walk over one second");
  v.real("accel_bias_sigma", accel_bias_sigma, {0, 5}, "m/s^2", "bias of the accelerometer");
  v.real("wheel_sigma", wheel_sigma, {0.001, 5}, "m/s", "of one reading of the wheels");
  v.real("wheel_scale_sigma", wheel_scale_sigma, {0, 0.5}, "-", "their scale: tires, pressure");
  v.real("heading_wait", heading_wait, {0, 600}, "s",
         "for a heading, after which the start frame is kept as world frame");
  v.reals("origin", origin, -1, {-1e4, 1e4}, "deg, deg, m",
          "latitude, longitude, height of the origin of the world frame; empty: the first fix");
  v.require(origin.empty() || origin.size() == 3,
            "origin: expected latitude, longitude and height");
  v.expert();
  v.text("gnss_label", gnss_label, "label of the receivers' observations; empty: all");
  v.text("imu_label", imu_label, "label of the inertial unit's observations; empty: all");
  v.text("wheels_label", wheels_label, "label of the wheels' odometry; empty: all");
  v.real("late", late, {0, 10}, "s", "largest delay of an observation of these sensors");
}

}  // namespace perception
