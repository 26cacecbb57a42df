#pragma once
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Kinematics.h"
#include "libperception/core/math/Random.h"

namespace perception {

/// The class filters of [radecki2016] at a fixed step: Euler integration, process noise in speed
/// and heading only, both initialized from the first measurement with the velocity towards the
/// second.
struct PaperClass {
  bool wheeled = false;                 ///< else walking: constant velocity
  double accel_sigma = 0.2;             ///< [m/s^2] standard deviation per step (method.md 3.3)
  double rotation_sigma = 0;            ///< [rad/s] wheeled: standard deviation per step
  double start_speed_variance = 40;     ///< [m^2/s^2] P_v (method.md 4.5)
  double start_heading_variance = 0.6;  ///< [rad^2] wheeled: P_theta
};

/// One filter's run over a track.
struct FilterTrace {
  std::vector<double> nis;          ///< by measurement; 0 for the first one, which initializes it
  std::vector<double> log_density;  ///< log N(y; S) by measurement
};

/// `z` [m] at steps of `dt` [s] under covariance `R` [m^2].
FilterTrace runPaperFilter(const PaperClass& object_class, const std::vector<Vector2>& z, double dt,
                           const Matrix2& R);

/// Simulated measurements of a track with the class's own dynamics. `speed` [m/s] at the start.
std::vector<Vector2> simulatePaperTrack(const PaperClass& object_class, double speed, int steps,
                                        double dt, const Matrix2& R, Rng& rng);

/// log of the chi-square density of `dof` degrees of freedom at x > 0: [radecki2016]'s "highest
/// chi2 probability" (method.md 4.5: the density, not the tail).
double logChi2Density(double x, double dof);

}  // namespace perception
