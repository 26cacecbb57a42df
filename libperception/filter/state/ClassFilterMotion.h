#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Whether the speed of an oriented filter is not zero, by two standard deviations.
bool movesSurely(const ClassFilter& f);
/// After an update: how far it has moved an oriented filter along its heading from the `predicted`
/// place [m] counts to the way traveled, as predictions do. A speed that detections do not confirm
/// adds no way.
void correctWay(const Vector2& predicted, ClassFilter& f);

/// Moves a class filter by dt >= 0 [s] (method.md 3). Motion modes interact first.
void predictClassFilter(const ObjectClass& object_class, double dt, ClassFilter& filter);
/// First step of predictClassFilter(), for batches: mixes the modes and appends the Gaussians to be
/// predicted by predictGaussian(); combineModes() is the last step.
void listSteps(const ObjectClass& object_class, double dt, ClassFilter& filter,
               std::vector<GaussianStep>& out);
inline void predictGaussian(const GaussianStep& step, Matrix4* transition = nullptr) {
  step.object_class->motion->predict(step, transition);
}

/// Kinematics q(state) that measurement models depend on, and its Jacobian.
inline Kinematics kinematicsOf(const ObjectClass& object_class, const ClassFilter& filter) {
  return object_class.motion->kinematics(filter.x, filter.oriented);
}

/// Initializes the motion modes of a new filter with their stationary probabilities.
void startModes(const ObjectClass& object_class, ClassFilter& filter);
/// Gives a new filter of a class without modes two components of its speed, as modes that do not
/// interact: with probability 1 - `share` its own covariance, else `sigma` [m/s] an axis.
void startTwoSpeeds(double share, double sigma, ClassFilter& filter);
/// Ends them once one component is beyond doubt.
void settleSpeeds(const ObjectClass& object_class, ClassFilter& filter);
/// Sets x and P of a filter with modes to the moments of the mixture.
void combineModes(ClassFilter& filter);

/// Converts an unoriented wheeled filter to heading along its velocity: [x, y, vx, vy] -> [x, y, v,
/// theta], covariance by the Jacobian.
void orientByVelocity(ClassFilter& filter);
/// The same along a known axis: theta is `yaw` or its opposite, whichever is closer to the
/// velocity; v is the velocity component along theta.
void orientByAxis(double yaw, double yaw_variance, ClassFilter& filter);
/// The same with known heading; v may be negative.
void orientAlong(double yaw, double yaw_variance, ClassFilter& filter);
/// The same for an oriented filter; v becomes the component of its velocity along the new heading.
void reorient(double yaw, double yaw_variance, ClassFilter& filter);
/// Kalman update of an oriented filter by a direct measurement of theta: residual [rad], variance
/// [rad^2].
void updateYaw(double y, double variance, ClassFilter& filter);
inline constexpr double kYawGate = 6.635;  ///< chi-square .99, one degree of freedom
/// The exact symmetry (v, theta) -> (-v, theta + pi) of an oriented filter (method.md 7).
void reverse(ClassFilter& filter);

}  // namespace perception
