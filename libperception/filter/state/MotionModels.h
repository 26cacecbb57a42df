#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// Moves a class filter by dt >= 0 [s]: method.md 3.1 (constant velocity), 3.2 (wheeled), static.
/// Long steps and uncertain headings are taken in sub-steps of at most 0.1 s. Motion modes interact
/// first.
void predictClassFilter(const ObjectClass& object_class, double dt, ClassFilter& filter);

/// One Gaussian of a moving class and the step that it takes.
struct GaussianStep {
  Vector4* x;
  Matrix4* P;
  const ObjectClass* object_class;
  double psd, damping;  ///< of its motion mode
  double dt;            ///< [s]
  bool oriented;
};
/// The parts of predictClassFilter, for batches: makes the modes interact and lists the Gaussians
/// that are left to move; combineModes() comes after them.
void beginPrediction(const ObjectClass& object_class, double dt, ClassFilter& filter,
                     std::vector<GaussianStep>& out);
/// Moves one Gaussian; `transition`, where asked for, becomes dx(after)/dx(before).
void predictGaussian(const GaussianStep& step, Matrix4* transition = nullptr);
/// Whether it has to be taken in sub-steps.
bool needsSubSteps(const GaussianStep& step);
/// Whether the heading is too uncertain for its tangent: moments then take the step (no batch).
bool hasUncertainHeading(const GaussianStep& step);

/// White acceleration through a speed that decays (rate `damping` [1/s]): integrals over the step.
/// Without decay the dt^3/3, dt^2/2, dt.
struct SpeedNoise {
  double decay = 1, effective_dt = 0;  ///< e^(-a dt); integral of it [s]
  double pp = 0, pv = 0, vv = 0;       ///< [s^3, s^2, s] times the power spectral density
  SpeedNoise(double damping, double dt);
};

/// What sensors can see of it: q(state) and its Jacobian.
Kinematics kinematicsOf(const ObjectClass& object_class, const ClassFilter& filter);

/// Gives a new filter the motion modes of its class, at the shares of time that they take.
void startModes(const ObjectClass& object_class, ClassFilter& filter);
/// x and P of a filter with modes from them: the mixture's mean and spread.
void combineModes(ClassFilter& filter);

/// Gives an unoriented wheeled filter its heading along its velocity: [x, y, vx, vy] -> [x, y, v,
/// theta], with the covariance carried by the Jacobian.
void orientByVelocity(ClassFilter& filter);
/// The same along a known axis: theta is `yaw` or its opposite, whichever the velocity prefers; v
/// is the velocity along.
void orientByAxis(double yaw, double yaw_variance, ClassFilter& filter);
/// The same with a known direction: v may be negative.
void orientAlong(double yaw, double yaw_variance, ClassFilter& filter);
/// The same of a filter that is oriented already: its velocity is kept as far as it lies along.
void reorient(double yaw, double yaw_variance, ClassFilter& filter);
/// A direct measurement of an oriented filter's theta: residual [rad] and variance.
void updateYaw(double y, double variance, ClassFilter& filter);
inline constexpr double kYawGate = 6.635;  ///< chi-square .99, one degree of freedom
/// The exact symmetry (v, theta) -> (-v, theta + pi) of an oriented filter (method.md 7).
void reverse(ClassFilter& filter);

}  // namespace perception
